"""Runs situations: the kitchens, the partners on the other seats, the counters, and the verdicts.

Axes: P parts (situations with a budget), R repeats of each, N = P * R rows, part by part; T steps.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import STAY
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.scenarios.language.counters import Counter, count_step
from overcooked_bench.scenarios.language.terms import Moment
from overcooked_bench.scenarios.scenario import HORIZON, Situation

NEVER_REACHED: Final = -1


class Part(NamedTuple):
    """A situation and the steps that A has in it."""

    situation: Situation
    budget: int

    @property
    def length(self) -> int:
        """Steps of a run: those before A is asked, and the budget."""
        return len(self.situation.before) + self.budget


class Stage:
    """Runs of situations that share a kitchen, all from their start.

    A run is decided once `accept` holds, `never` holds, or the budget is used up; what happens in its kitchen later
    does not matter, and its partner stands still.

    Args:
        parts: Situations of one layout and cooking mode, with their budgets.
        repeats: R.
        history: Past states that observations need, as for `Kitchens`.

    Attributes:
        kitchens: N kitchens.
        seats: (N,) int64, A's seat in each.
        step: Joint actions played so far.
        decided: (N,) bool.
        passed: (N,) bool.
        reached: (N,) int64, the step of A at which `accept` held, -1 if it did not.
        actions: (T, N, 2) uint8, joint actions; T is the longest run's length.
    """

    def __init__(self, parts: Sequence[Part], repeats: int = 1, history: int = 0) -> None:
        first, n = parts[0].situation, len(parts) * repeats
        self.parts, self.repeats = tuple(parts), repeats
        self.kitchens = Kitchens(
            *(first.layout, n),
            cooking=first.scenario.cooking,
            horizon=HORIZON,
            start="random",
            actions_taken=True,
            history=history,
            autoreset=False,
        )
        for row in range(n):
            part = self.parts[row // repeats]
            self.kitchens.set_state(row, part.situation.first_state(part.budget))
        self.seats = np.repeat([part.situation.seat for part in self.parts], repeats)
        self.step = 0
        self.decided, self.passed = np.zeros(n, np.bool_), np.zeros(n, np.bool_)
        self.reached = np.full(n, NEVER_REACHED)
        self.actions = np.full((max(part.length for part in self.parts), n, 2), STAY, np.uint8)
        self._counters: list[Counter] = sorted({c for p in self.parts for c in p.situation.counters}, key=str)
        self._counts = np.zeros((n, len(self._counters)), np.int64)
        self._preludes = np.repeat([len(part.situation.before) for part in self.parts], repeats)
        self._everybody = np.arange(n)
        self._known: dict[tuple[int, int, bytes], int] = {}
        self._judge()

    @property
    def over(self) -> bool:
        """Whether every run is decided."""
        return bool(self.decided.all())

    def play(self, own: NDArray[np.int64]) -> None:
        """Plays one step.

        Args:
            own: (N,) int64, A's actions; ignored in runs whose `before` is still being played.
        """
        joint = np.empty((len(own), 2), np.int64)
        joint[self._everybody, self.seats] = own
        joint[self._everybody, 1 - self.seats] = STAY
        for index in range(len(self.parts)):
            self._partners(index, joint)
        self.actions[self.step] = joint
        result = self.kitchens.step(joint)
        counted = self.step >= self._preludes
        assert result.actions_taken is not None
        rows, tables = self.kitchens.batch.rows, self.kitchens.tables
        gained = count_step(self._counters, self.seats, tables, rows, result.actions_taken)
        self._counts += np.where(counted[:, None], gained, 0)
        self.step += 1
        self._judge()
        if result.truncated.any() and not self.over:
            self.kitchens.reset(mask=result.truncated)  # its run is decided; it continues so that the others can

    def truth(self, row: int, conditions: Sequence[object]) -> list[bool]:
        """Returns which conditions hold in a row now."""
        moment = self._moment(slice(row, row + 1), self.parts[row // self.repeats].situation)
        return [bool(condition.value(moment)[0]) for condition in conditions]  # type: ignore[attr-defined]

    def _rows(self, index: int) -> slice:
        return slice(index * self.repeats, (index + 1) * self.repeats)

    def _partners(self, index: int, joint: NDArray[np.int64]) -> None:
        """Writes B's actions in the runs of a part, and A's actions as long as `before` is being played."""
        situation, rows = self.parts[index].situation, self._rows(index)
        time = self.step - len(situation.before)
        if time < 0:
            joint[rows] = situation.before[self.step]
            return
        behaviour, seat = situation.behaviour, situation.partner_seat
        phase = behaviour.phase(time)
        for row in range(rows.start, rows.stop):
            if self.decided[row]:
                continue
            key = index, phase, self.kitchens.batch.rows[row].tobytes()
            if key not in self._known:
                self._known[key] = behaviour.act(situation.layout, self.kitchens.state(row), seat, time)
            joint[row, seat] = self._known[key]

    def _judge(self) -> None:
        for index, (situation, budget) in enumerate(self.parts):
            rows = self._rows(index)
            time = self.step - len(situation.before)
            if time < 0 or self.decided[rows].all():
                continue
            moment = self._moment(rows, situation)
            spoiled = situation.never.value(moment) if situation.never else np.zeros(self.repeats, np.bool_)
            accepted = situation.accept.value(moment) & ~spoiled & ~self.decided[rows]
            self.reached[rows][accepted] = time
            self.passed[rows] |= accepted
            self.decided[rows] |= accepted | spoiled | (time >= budget)

    def _moment(self, rows: slice, situation: Situation) -> Moment:
        counts = {counter: self._counts[rows, k] for k, counter in enumerate(self._counters)}
        return Moment(situation.layout, self.kitchens.batch.rows[rows], situation.seat, counts)
