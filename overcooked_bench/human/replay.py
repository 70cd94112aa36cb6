"""Plays recorded games again, many at once: `replay` yields them step by step.

Axes: R games of one batch that are running.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import groupby
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.human.game import Game
from overcooked_bench.kitchen.codes import STAY
from overcooked_bench.kitchen.kitchens import Kitchens, StepResult
from overcooked_bench.kitchen.observations.registry import history_for

_MOST_ROWS: Final = 512


@dataclass
class Moment:
    """One step of all games of a batch that are running; they are of one layout and cooking mode.

    Attributes:
        kitchens: Where they are played; other rows than `rows` show nothing of interest. Its clock is not that of the
            games, see `steps`.
        rows: (R,) int64, the games' rows there.
        games: (R,) int64, the games' places in the list that `replay` was given.
        steps: (R,) int64, the step that each game is at, from 0.
        actions: (R, 2) uint8, the joint actions of this step.
    """

    kitchens: Kitchens
    rows: NDArray[np.int64]
    games: NDArray[np.int64]
    steps: NDArray[np.int64]
    actions: NDArray[np.uint8]
    _joint: NDArray[np.int64]
    _result: StepResult | None = None

    def observe(self, name: str) -> NDArray[Any]:
        """Returns the observations, (R, 2, *shape), [:, k] as chef k sees it: before the step until `play` is called.

        Raises:
            WrongUse: No observation of this name, one that this layout cannot be shown in, or a stack that `replay` was
                not asked for.
        """
        return self.kitchens.observe(name)[self.rows]

    def play(self) -> StepResult:
        """Plays the step, once, and returns what it brought, with R rows; `replay` does it if nobody else has."""
        if self._result is None:
            arrays = self.kitchens.step(self._joint)
            self._result = StepResult(*(None if array is None else array[self.rows] for array in arrays))  # type: ignore[arg-type]
        return self._result


def replay(games: Sequence[Game], *, observations: Iterable[str] = (), events: bool = False) -> Iterator[Moment]:
    """Plays recorded games again, exactly as they were played.

    A kitchen's observations may depend on the steps that are left; every game has its own horizon here.

    Args:
        games: In any order, of any layouts.
        observations: What will be observed; only stacks of past states need to be named.
        events: Whether `StepResult.events` is wanted; `actions_taken` always is.

    Yields:
        Moments, before their step: layout by layout, all steps of a batch of games after each other.

    Raises:
        WrongUse: A layout or a start state cannot be played.

    Example:
        ```python
        from overcooked_bench.human.replay import replay

        for moment in replay(games):
            seen = moment.observe("lossless")  # (R, 2, ...) before the step, with moment.actions
            result = moment.play()  # StepResult of R rows: what the step brought
        ```
    """
    history = history_for(observations)

    def where(index: int) -> tuple[str, str]:
        return games[index].layout, games[index].cooking

    for (_, cooking), some in groupby(sorted(range(len(games)), key=where), key=where):
        # games of similar horizon and length together, so that few rows wait for others
        order = sorted(some, key=lambda index: (-games[index].horizon, -games[index].steps))
        for first in range(0, len(order), _MOST_ROWS):
            batch = order[first : first + _MOST_ROWS]
            kitchens = Kitchens(
                games[batch[0]].kitchen,
                len(batch),
                cooking=cooking,
                horizon=games[batch[0]].horizon,
                events=events,
                actions_taken=True,
                history=history,
                autoreset=False,
            )
            yield from _play([games[index] for index in batch], np.array(batch), kitchens)


def _play(games: list[Game], places: NDArray[np.int64], kitchens: Kitchens) -> Iterator[Moment]:
    """Plays games that would reach their horizons at the same time: those of a shorter horizon start later.

    Steps in which no game is running are left out, so the work is bounded by the steps that were recorded.
    """
    n, horizon = len(games), kitchens.horizon
    begins = np.array([horizon - game.horizon for game in games])
    ends = begins + [game.steps for game in games]
    actions = np.full((ends.max(), n, 2), STAY, np.uint8)
    for row, game in enumerate(games):
        actions[begins[row] : ends[row], row] = game.joint_actions()
    kitchens.reset(seed=0)
    running = np.zeros(len(actions), np.bool_)
    for begin, end in zip(begins.tolist(), ends.tolist(), strict=True):
        running[begin:end] = True
    for clock in np.flatnonzero(running).tolist():
        for row in np.flatnonzero(begins == clock).tolist():
            kitchens.set_state(row, replace(games[row].first_state(), timestep=clock))
        rows, joint = np.flatnonzero((begins <= clock) & (clock < ends)), actions[clock]
        moment = Moment(kitchens, rows, places[rows], clock - begins[rows], joint[rows], joint.astype(np.int64))
        yield moment
        moment.play()
