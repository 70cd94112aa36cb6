"""Plays some cells of a result again and compares them with what was recorded.

Cells are drawn as whole batches, as the score played them: only then are the same bytes promised.
"""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from math import ceil
from typing import Final, NamedTuple

import numpy as np

from overcooked_bench.evaluation.comparing.permutation import over_units
from overcooked_bench.evaluation.games.block import Block, Outcome, rows_of
from overcooked_bench.evaluation.games.cutting import cut
from overcooked_bench.evaluation.games.episode import BlockKey, Episode
from overcooked_bench.evaluation.games.store import Store

SHARE: Final = 0.02
LEAST: Final = 20
LEVEL: Final = 0.001
"""p below which returns of other machines or versions are taken for those of another agent."""


class Compared(NamedTuple):
    """How cells came out when they were played again.

    Attributes:
        cells: How many were compared.
        same: How many of them are equal in every column, the joint actions included.
        p: Two-sided p of the mean difference of returns; 1 if there is none.
        first: The first cell that differs, None if none does.
    """

    cells: int
    same: int
    p: float
    first: str | None


def batches(store: Store, first: Block, training_seeds: int) -> list[Block]:
    """Lists the batches of a score that its store holds whole.

    Args:
        store: The episodes.
        first: A block of the score, whatever its layout, training seed and start states.
        training_seeds: S.
    """
    known, adapted = store.blocks(), store.adapted()
    layouts = [layout for layout in first.protocol.play.layouts if any(layout == key[0] for key in known)]
    blocks = cut(first, layouts, training_seeds) if layouts else []
    return [replace(block, adapted=block.layout in adapted) for block in blocks if known.issuperset(block.keys)]


def draw(blocks: Sequence[Block], seed: int, everything: bool = False) -> list[Block]:
    """Draws batches at random until they hold 2 % of all cells, and 20 at least.

    Args:
        blocks: All of them.
        seed: Of the draw.
        everything: Whether all are wanted.
    """
    rows = [rows_of(block) for block in blocks]
    wanted = sum(rows) if everything else max(LEAST, ceil(SHARE * sum(rows)))
    drawn, number = [], 0
    for index in np.random.default_rng(seed).permutation(len(blocks)).tolist():
        if number >= wanted:
            break
        drawn.append(blocks[index])
        number += rows[index]
    return drawn


def recorded(store: Store, keys: Sequence[BlockKey]) -> dict[BlockKey, list[Episode]]:
    """Reads the episodes of some blocks.

    Raises:
        StoreError: A block is not as it was written.
    """
    found: dict[BlockKey, list[Episode]] = {key: [] for key in keys}
    for episode in store.episodes():
        if episode.block in found:
            found[episode.block].append(episode)
    return found


def compare(outcomes: Sequence[Outcome], before: Mapping[BlockKey, Sequence[Episode]]) -> Compared:
    """Compares batches that were played again, cell by cell; returns by flipping the signs of their differences.

    Args:
        outcomes: What became of them; a fault of the agent makes all its cells differ.
        before: The recorded episodes of their blocks.
    """
    cells, same, first, changes = 0, 0, None, []
    for outcome in outcomes:
        now = {(one.block, one.partner, one.seat): one for one in outcome.episodes}
        for key in outcome.block.keys:
            for old in before[key]:
                new = now.get((key, old.partner, old.seat))
                cells += 1
                same += new == old
                if new != old and first is None:
                    first = outcome.fault or old.cell
                changes.append((new.soup_reward if new else 0.0) - old.soup_reward)
    return Compared(cells, same, over_units(changes), first)
