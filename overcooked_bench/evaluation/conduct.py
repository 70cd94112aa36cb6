"""How two chefs cooperate, counted by playing stored episodes again.

Axes: N episodes of one layout, C cells of the grid, D deeds.
"""

from collections.abc import Sequence
from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.games.episode import Episode
from overcooked_bench.kitchen.codes import BLOCKED, DIRECTIONS, PICKED_UP, POTTED, PUT_DOWN, STAY
from overcooked_bench.kitchen.kitchens import Kitchens, StepResult

CONDUCT: Final = ("pots", "hand_overs", "blocked", "idle")
"""What is counted of each chef: ingredients put into pots; objects put on a counter that the other chef was the next to
pick up; steps in which the other chef kept it out of a floor cell; and steps with the action stay."""

BOTH: Final = ({"chef": 0}, {"chef": 1})
"""Parameters of metrics of conduct: the scored agent, and its partner."""

_SHARES: Final = [CONDUCT.index("blocked"), CONDUCT.index("idle")]
_MOST_ROWS: Final = 2048


def count_conduct(episodes: Sequence[Episode], cooking: str, horizon: int) -> NDArray[np.float64]:
    """Counts what the chefs of stored episodes of one layout did.

    Args:
        episodes: N episodes that were replayed before, see `replayed.check_returns`.
        cooking: The protocol's cooking mode.
        horizon: The protocol's number of steps.

    Returns:
        (N, 2, D) of the scored agent and of its partner: numbers per episode, and shares of its steps.
    """
    parts = [episodes[first : first + _MOST_ROWS] for first in range(0, len(episodes), _MOST_ROWS)]
    by_seat = np.concatenate([_replay(part, cooking, horizon) for part in parts])
    by_seat[..., _SHARES] /= horizon
    seats = np.array([episode.seat for episode in episodes])
    return np.stack([by_seat[np.arange(len(seats)), seats], by_seat[np.arange(len(seats)), 1 - seats]], axis=1)


def of_chef(cells: Cells, name: str, chef: float) -> NDArray[np.float64]:
    """Returns what a chef did with each partner.

    Args:
        cells: With the conduct of their episodes.
        name: One of `CONDUCT`.
        chef: 0 for the scored agent, 1 for its partner.

    Returns:
        (R, P) for each training seed, or episode block of the only one; (0, P) if it was not counted.
    """
    if cells.conduct is None:
        return np.empty((0, len(cells.partners)))
    return cells.per_partner(cells.conduct[..., int(chef), CONDUCT.index(name)])


def _replay(episodes: Sequence[Episode], cooking: str, horizon: int) -> NDArray[np.float64]:
    """Returns (N, 2, D) counts by seat."""
    n = len(episodes)
    kitchens = Kitchens(episodes[0].layout, n, cooking=cooking, horizon=horizon, actions_taken=True, autoreset=False)
    joint = np.empty((horizon, n, 2), np.int64)
    for row, episode in enumerate(episodes):
        kitchens.set_state(row, episode.first_state)
        joint[:, row] = episode.joint_actions(horizon)
    watcher = _Watcher(kitchens)
    for actions in joint:
        watcher.watch(actions, kitchens.step(actions))
    return watcher.counts.astype(np.float64)


class _Watcher:
    """Counts, step by step, what the chefs of N kitchens do."""

    def __init__(self, kitchens: Kitchens) -> None:
        self._batch, n, width = kitchens.batch, kitchens.num_kitchens, kitchens.layout.width
        self.counts = np.zeros((n, 2, len(CONDUCT)), np.int64)
        self._ahead = np.array([x + width * y for x, y in DIRECTIONS])
        self._put_by = np.full((n, width * kitchens.layout.height), -1, np.int8)  # chef that put down what is there

    def watch(self, actions: NDArray[np.int64], result: StepResult) -> None:
        """Takes a step in."""
        taken = result.actions_taken
        assert taken is not None
        self.counts[..., 0] += taken & POTTED != 0
        self.counts[..., 2] += taken & BLOCKED != 0
        self.counts[..., 3] += actions == STAY
        faced = self._batch.position + self._ahead[self._batch.facing]
        for chef in range(2):  # in the order of the game
            self._hand(chef, taken[:, chef], faced[:, chef])

    def _hand(self, chef: int, taken: NDArray[np.uint16], faced: NDArray[np.int64]) -> None:
        """Follows objects on counters from one chef to the other."""
        down, up = np.flatnonzero(taken & PUT_DOWN), np.flatnonzero(taken & PICKED_UP)
        self._put_by[down, faced[down]] = chef
        handed = up[self._put_by[up, faced[up]] == 1 - chef]
        self.counts[handed, 1 - chef, 1] += 1
        self._put_by[up, faced[up]] = -1
