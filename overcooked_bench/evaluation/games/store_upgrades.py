"""Reads the stores that older versions wrote."""

import sqlite3
from collections.abc import Callable, Mapping
from typing import Any, Final

from overcooked_bench.evaluation.games.episode import COLUMNS, BlockKey, Episode, read_row, side_of
from overcooked_bench.kitchen.layout import Layout

Content = tuple[dict[str, str], dict[BlockKey, tuple[bool, list[Episode]]]]
"""Facts, and for each finished block whether it was played in the mirror image, and its episodes."""


def _from_1(old: sqlite3.Connection) -> Content:
    """Schema 1 had neither checksums nor the column `side`, which follows from the start state."""
    found = {name for (name,) in old.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
    if found != {"facts", "blocks", "episodes"}:
        raise ValueError("its tables are not those of schema 1")
    facts = dict(old.execute("SELECT key, value FROM facts"))
    blocks: dict[BlockKey, tuple[bool, list[Episode]]] = {}
    for *key, adapted in old.execute("SELECT layout, training_seed, episode, adapted FROM blocks"):
        layout, training_seed, episode = key
        blocks[layout, training_seed, episode] = bool(adapted), []
    layouts: dict[str, Layout] = {}
    names = [name for name in COLUMNS if name != "side"]
    for row in old.execute(f"SELECT {', '.join(names)} FROM episodes"):
        episode = _with_side(dict(zip(names, row, strict=True)), layouts)
        blocks[episode.block][1].append(episode)
    return facts, blocks


def _with_side(row: Mapping[str, Any], layouts: dict[str, Layout]) -> Episode:
    whole = {**row, "side": 0}
    episode = read_row(whole[name] for name in COLUMNS)
    layout = layouts.setdefault(episode.layout, Layout.load(episode.layout))
    whole["side"] = side_of(layout, episode.first_state, episode.seat)
    return read_row(whole[name] for name in COLUMNS)


UPGRADES: Final[dict[str, Callable[[sqlite3.Connection], Content]]] = {"1": _from_1}
"""Schema -> what reads it."""
