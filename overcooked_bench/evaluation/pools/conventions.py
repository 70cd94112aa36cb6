"""The conventions of agents: what they do where two chefs have to agree, measured from their games.

Axes: N players, E episodes from each seat.
"""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from overcooked_bench.evaluation.games.engines import map_tasks
from overcooked_bench.evaluation.games.episode import side_of
from overcooked_bench.evaluation.games.play import Games
from overcooked_bench.evaluation.pools.axes import AXES, MIXED, Seen
from overcooked_bench.evaluation.pools.pairs import Block, cut, play_games
from overcooked_bench.evaluation.pools.players import Player
from overcooked_bench.kitchen.codes import ACTION_NAMES
from overcooked_bench.kitchen.kitchens import Kitchens, StepResult
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.kitchen.tracks.counts import count
from overcooked_bench.kitchen.tracks.track import Track

EPISODES: Final = 20
HELPER: Final = "greedy"
"""Who plays with an agent whose copies do too little together."""
DOMINATES: Final = 2 / 3
"""Share from which a value is an agent's convention."""
FEWEST: Final = 20
"""With less that speaks for any value nothing is said."""
_PURPOSE: Final = "conventions"
_HORIZON: Final = 400

Amounts = Mapping[str, Mapping[str, float]]
"""Axis -> value -> what speaks for it."""


def conventions(
    layout: str,
    players: Sequence[Player],
    episodes: int = EPISODES,
    seed: int = 0,
    workers: int = 1,
    engine: str = "local",
) -> list[str]:
    """Measures what agents do on the axes of a layout, from random starts.

    Each plays with a copy of itself; on an axis on which the copies do too little together, it plays with `HELPER`.

    Args:
        layout: A shipped layout.
        players: N agents.
        episodes: E, per seat.
        seed: Of all streams.
        workers: Processes.
        engine: "local", "dask" or "ray".

    Returns:
        N texts such as "onions=top, dishes=bottom", as `read_convention` reads them; an axis on which an agent does too
        little even with the helper is left out. All are empty on a layout without axes.

    Raises:
        WrongUse, PoolError: As `meet`.
    """
    if not AXES.get(layout):
        return [""] * len(players)
    everybody = [*players, Player.scripted(HELPER, layout)]
    where = episodes, seed, workers, engine
    with_copies = _amounts(layout, everybody, [(i, i) for i in range(len(players))], *where)
    weak = [i for i, found in enumerate(with_copies) if not all(map(enough, found.values()))]
    helped = _amounts(layout, everybody, [(i, len(players)) for i in weak], *where)
    chosen = [dict(found) for found in with_copies]
    for i, found in zip(weak, helped, strict=True):
        chosen[i].update({axis: amounts for axis, amounts in found.items() if not enough(chosen[i][axis])})
    return [
        write_convention({axis: value_of(amounts) for axis, amounts in found.items() if enough(amounts)})
        for found in chosen
    ]


def enough(amounts: Mapping[str, float]) -> bool:
    """Returns whether so much speaks for any values that one can be named."""
    return sum(max(0.0, amount) for amount in amounts.values()) >= FEWEST


def value_of(amounts: Mapping[str, float]) -> str:
    """Returns the value for which at least two thirds speak, or `MIXED`."""
    value, most = max(amounts.items(), key=lambda pair: pair[1])
    return value if most >= DOMINATES * sum(max(0.0, amount) for amount in amounts.values()) else MIXED


def write_convention(values: Mapping[str, str]) -> str:
    """Writes axis -> value as a text such as "onions=top, dishes=bottom"."""
    return ", ".join(f"{axis}={value}" for axis, value in values.items())


def read_convention(text: str | None) -> dict[str, str]:
    """Reads a text of `write_convention`: axis -> value; nothing from an empty text or None.

    Raises:
        ValueError: It is no such text.
    """
    parts = [part.split("=") for part in text.split(", ")] if text else []
    if any(len(part) != 2 or not all(part) for part in parts):
        raise ValueError(f"{text!r} is no convention; write it as 'onions=top, dishes=bottom'")
    return {axis: value for axis, value in parts}


def _amounts(
    layout: str,
    players: Sequence[Player],
    pairs: Sequence[tuple[int, int]],
    episodes: int,
    seed: int,
    workers: int,
    engine: str,
) -> list[Amounts]:
    """Returns what speaks for each value of each axis, for the agent of each pair."""
    blocks = list(cut(layout, players, pairs, episodes, _PURPOSE, seed, _HORIZON))
    found: dict[int, list[Amounts]] = dict(map_tasks(_measure, blocks, max(1, min(workers, len(blocks))), engine))
    return [amounts for first in sorted(found) for amounts in found[first]]


def _measure(block: Block) -> tuple[int, list[Amounts]]:
    """Plays a block: its `first`, and the amounts of each of its pairs."""
    layout, recorder = Layout.load(block.layout), _Recorder(block)
    games = play_games(block, recorder.watch)
    found = [{axis.name: dict.fromkeys(axis.values, 0.0) for axis in AXES[block.layout]} for _ in block.pairs]
    for row, (start, seat) in enumerate(zip(games.starts, block.seats.tolist(), strict=True)):
        agent, partner = block.pairs[pair := row // (2 * block.episodes)]
        counts = count(layout, recorder.track(row, start, games))
        sides = side_of(layout, start, 0), side_of(layout, start, 1)
        seen = Seen(layout, counts, (0, 1) if agent == partner else (seat,), sides)
        for axis in AXES[block.layout]:
            for value, amount in axis.speaks(seen).items():
                found[pair][axis.name][value] += amount
    return block.first, list(found)


class _Recorder:
    """Takes down what happens in the games of a block, for their tracks."""

    def __init__(self, block: Block) -> None:
        self._cells, self._facing = np.zeros((2, block.horizon + 1, block.rows, 2), np.uint16)
        self._taken = np.zeros((block.horizon, block.rows, 2), np.uint16)
        self._steps = 0
        self._width = Layout.load(block.layout).width

    def watch(self, kitchens: Kitchens, result: StepResult) -> None:
        """Takes a step down."""
        assert result.actions_taken is not None
        self._taken[self._steps] = result.actions_taken
        self._steps += 1
        self._cells[self._steps], self._facing[self._steps] = kitchens.batch.position, kitchens.batch.facing

    def track(self, row: int, start: KitchenState, games: Games) -> Track:
        """Returns the track of a game that started in this state."""
        cells, facing = self._cells[:, row], self._facing[:, row]
        for chef, state in enumerate(start.chefs):
            x, y = state.position
            cells[0, chef], facing[0, chef] = y * self._width + x, ACTION_NAMES.index(state.facing)
        return Track(cells, facing, games.actions[:, row], self._taken[:, row], games.soup_reward[row])
