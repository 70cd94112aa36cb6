"""What happened in recorded games, step by step, as arrays."""

from collections.abc import Iterator, Sequence
from typing import Final

import numpy as np

from overcooked_bench.human.game import Game
from overcooked_bench.human.replay import replay
from overcooked_bench.kitchen.tracks.track import Track

_MOST_GAMES: Final = 512  # whose arrays are in memory together


def follow(games: Sequence[Game]) -> Iterator[Track]:
    """Plays games again and yields what happened in each, in their order.

    Raises:
        WrongUse: A game cannot be played.
    """
    for first in range(0, len(games), _MOST_GAMES):
        yield from _follow(games[first : first + _MOST_GAMES])


def _follow(games: Sequence[Game]) -> Iterator[Track]:
    longest = max(game.steps for game in games)
    cells, facing = np.zeros((2, len(games), longest + 1, 2), np.uint16)
    taken, points = np.zeros((len(games), longest, 2), np.uint16), np.zeros((len(games), 2))
    for moment in replay(games):
        batch, rows, now = moment.kitchens.batch, moment.rows, (moment.games, moment.steps)
        cells[now], facing[now] = batch.position[rows], batch.facing[rows]
        result, then = moment.play(), (moment.games, moment.steps + 1)
        assert result.actions_taken is not None
        cells[then], facing[then] = batch.position[rows], batch.facing[rows]
        taken[now] = result.actions_taken
        points[moment.games] += result.soup_reward
    for row, game in enumerate(games):
        ends = game.steps + 1
        joint = game.joint_actions()
        yield Track(cells[row, :ends], facing[row, :ends], joint, taken[row, : game.steps], points[row])
