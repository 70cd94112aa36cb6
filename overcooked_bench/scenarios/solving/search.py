"""Breadth-first search over both chefs' joint state, with a partner whose action in every state is known.

Axes: N states of one layer, K counters, R columns of a kitchen's row.
"""

from collections.abc import Mapping, Sequence
from functools import lru_cache
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import CELLS, FACING, HELD, POSITION, Batch
from overcooked_bench.kitchen.codes import COUNTER, NUM_ACTIONS, POT_IDLE
from overcooked_bench.kitchen.convert import read_state, write_state
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.rules import step_and_note
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.kitchen.tables import Tables, compile_tables
from overcooked_bench.scenarios.language.counters import Counter, count_step
from overcooked_bench.scenarios.language.terms import Condition, Moment

if TYPE_CHECKING:
    from overcooked_bench.agents.behaviours.behaviour import Behaviour

ENDLESS: Final = 1 << 40
"""A horizon that no search reaches: the caller limits a scenario's length."""

MOST_STATES: Final = 1 << 20
"""States after which a search is given up; about five seconds and 400 MB."""

TOGETHER: Final = 682
"""States whose children are stepped in one call; it takes 4 MB of observations that nobody looks at."""

_BYTE: Final = 255
_Rows = NDArray[np.uint16]


class Found(NamedTuple):
    """A shortest way to make a condition true.

    Attributes:
        actions: Chef A's actions, one per step.
        partner: Chef B's actions.
    """

    actions: tuple[int, ...]
    partner: tuple[int, ...]


class TooManyStates(RuntimeError):
    """A search was given up, and nothing is known."""


class Search:
    """Searches in one kitchen for one goal.

    Args:
        layout: The kitchen's.
        cooking: "auto" or "manual".
        seat: Chef A's seat.
        accept: What has to hold at some step.
        never: What must not hold before, nor then.
        limits: Each counter of the two -> a count that is equivalent to any greater one.
    """

    def __init__(
        self,
        layout: Layout,
        cooking: str,
        seat: int,
        accept: Condition,
        never: Condition | None,
        limits: Mapping[Counter, int],
    ) -> None:
        self._layout, self._seat, self._accept, self._never = layout, seat, accept, never
        self._tables = _compiled(layout, cooking)
        self._counters = tuple(limits)
        self._limits = np.array([limits[counter] for counter in self._counters], np.uint16)
        self._columns = len(self._tables.fresh) + CELLS + len(self._tables.pots)
        alters = (self._tables.fresh == POT_IDLE) | (self._tables.fresh == COUNTER)
        self._places = np.flatnonzero(self._tables.fresh == COUNTER)
        everywhere = np.concatenate([np.ones(CELLS, np.bool_), alters, np.ones(len(self._tables.pots), np.bool_)])
        self._changing = np.flatnonzero(everywhere)
        greatest = max([len(self._tables.fresh), *limits.values()])
        self._small = np.uint8 if greatest <= _BYTE else np.uint16
        self._scratch = Batch(1, len(self._tables.fresh), len(self._tables.pots))
        self._desk = _Desk(self._tables)
        self._answers: dict[Behaviour, Answers] = {}

    def row(self, state: KitchenState) -> _Rows:
        """Returns a state as a kitchen's row, (R,)."""
        write_state(self._scratch, self._tables, self._layout, 0, state, ENDLESS)
        row: _Rows = self._scratch.rows[0].copy()
        return row

    def step(self, row: _Rows, counts: _Rows, actions: Sequence[int]) -> tuple[_Rows, _Rows]:
        """Plays one joint action.

        Args:
            row: (R,)
            counts: (K,) up to their limits.
            actions: In the order of the seats.

        Returns:
            The next row and counts.
        """
        after, taken = self._desk.step(row[None], np.array([actions], np.int64))
        return after[0], self.count(after, taken, counts[None])[0]

    def answer(self, row: _Rows, partner: "Behaviour", t: int) -> int:
        """Asks a partner what it does in a state, (R,)."""
        self._scratch.rows[0] = row
        state = read_state(self._scratch, self._tables, self._layout, 0)
        return partner.act(self._layout, state, 1 - self._seat, t)

    def no_counts(self) -> _Rows:
        """Returns the counts of a start, (K,)."""
        return np.zeros(len(self._counters), np.uint16)

    def judge(self, rows: _Rows, counts: _Rows) -> tuple[NDArray[np.bool_], NDArray[np.bool_]]:
        """Returns (N,) whether the goal is reached in each state, and (N,) whether it can never be reached from it."""
        each = {counter: counts[:, k].astype(np.int64) for k, counter in enumerate(self._counters)}
        moment = Moment(self._layout, rows, self._seat, each)
        lost = np.zeros(len(rows), np.bool_) if self._never is None else self._never.value(moment)
        return self._accept.value(moment) & ~lost, lost

    def run(
        self,
        row: _Rows,
        counts: _Rows,
        partner: "Behaviour",
        t: int,
        limit: int,
        most: int = MOST_STATES,
        clutter: int | None = None,
    ) -> Found | None:
        """Finds a shortest way to the goal.

        Args:
            row: The state to start from, (R,).
            counts: What has happened before, (K,).
            partner: Chef B's behaviour.
            t: The partner's time.
            limit: Steps within which to reach the goal.
            most: States after which to give up.
            clutter: Limit on further objects on counters; with it the way that is found may be longer than the
                shortest one, and a way may exist although none is found.

        Returns:
            The way, or None if there is none.

        Raises:
            TooManyStates: The search was given up.
        """
        rows, counted = row[None], counts[None]
        reached, lost = self.judge(rows, counted)
        if reached[0] or lost[0]:
            return Found((), ()) if reached[0] else None
        things = self._columns if clutter is None else int(self._things(rows)[0]) + clutter
        answers = self._answers.get(partner)
        if answers is None:
            answers = Answers(partner, self._layout, self._tables, 1 - self._seat, self._scratch)
            self._answers[partner] = answers
        seen = set(self._keys(rows, counted, partner.phase(t)))
        layers: list[tuple[NDArray[np.int64], NDArray[np.int64]]] = []
        for now in range(t, t + limit):
            phase = partner.phase(now + 1)
            joint = answers.joint(rows, self._seat, now)
            children, child_counts, parents, goal = self._expand(rows, counted, joint, phase, seen, things)
            layers.append((parents, joint[parents]))
            if goal >= 0:
                return _trace(layers, goal, self._seat)
            if not len(children):
                return None
            if len(seen) > most:
                raise TooManyStates(f"no solution found within {now + 1 - t} steps and {len(seen)} states")
            rows, counted = children, child_counts
        return None

    def _expand(
        self, rows: _Rows, counts: _Rows, joint: NDArray[np.int64], phase: int, seen: set[bytes], things: int
    ) -> tuple[_Rows, _Rows, NDArray[np.int64], int]:
        """Plays all N x 6 joint actions.

        Returns:
            The states that are new, their counts, the joint action each comes from, and the first that is a goal or -1.
        """
        kept: list[tuple[_Rows, _Rows, NDArray[np.int64]]] = []
        number = 0
        for start in range(0, len(rows), TOGETHER):
            part = slice(start, start + TOGETHER)
            before = np.repeat(rows[part], NUM_ACTIONS, axis=0)
            actions = joint[start * NUM_ACTIONS : (start + TOGETHER) * NUM_ACTIONS]
            after, taken = self._desk.step(before, actions)
            counted = self.count(after, taken, np.repeat(counts[part], NUM_ACTIONS, axis=0))
            keys = self._keys(after, counted, phase)
            first = dict(zip(reversed(keys), range(len(keys) - 1, -1, -1), strict=True))
            unseen = first.keys() - seen
            seen |= unseen
            new = sorted(map(first.__getitem__, unseen))
            reached, lost = self.judge(after[new], counted[new])
            lost |= self._things(after[new]) > things
            chosen = np.array(new, np.int64)[~lost]
            kept.append((after[chosen], counted[chosen], chosen + start * NUM_ACTIONS))
            if reached[~lost].any():
                number += int(np.argmax(reached[~lost]))
                return *_joined(kept), number
            number += len(chosen)
        return *_joined(kept), -1

    def count(self, after: _Rows, taken: _Rows, counts: _Rows) -> _Rows:
        """Adds the events of a step to the counts.

        Args:
            after: (N, R)
            taken: (N, 2) what the chefs did in it.
            counts: (N, K) before the step.

        Returns:
            (N, K), up to their limits.
        """
        if not self._counters:
            return counts
        seats = np.full(len(after), self._seat)
        brought = count_step(self._counters, seats, self._tables, after, taken)
        return np.minimum(counts + brought.astype(np.uint16), self._limits)

    def _things(self, rows: _Rows) -> NDArray[np.int64]:
        """Counts the objects on counters, (N,)."""
        cells = rows[:, CELLS:][:, self._places]
        counted: NDArray[np.int64] = np.sum(cells != COUNTER, axis=1, dtype=np.int64)
        return counted

    def _keys(self, rows: _Rows, counts: _Rows, phase: int) -> list[bytes]:
        """Returns keys that distinguish the states of N kitchens at one time."""
        marks = len(self._changing) + len(self._counters)
        told = np.empty((len(rows), marks + 2), self._small)
        told[:, : len(self._changing)] = rows[:, self._changing]
        told[:, len(self._changing) : marks] = counts
        told[:, marks:] = phase & _BYTE, phase >> 8
        keys: list[bytes] = told.view(f"V{told.itemsize * told.shape[1]}").ravel().tolist()
        return keys


class _Desk:
    """Steps many kitchens at once, with the arrays that the shipped step wants besides the rows."""

    def __init__(self, tables: Tables) -> None:
        self._tables = (tables.ways, tables.outcomes, tables.by_code, tables.payments, tables.pots)
        self._room = 0
        self._cells = len(tables.fresh)

    def step(self, rows: _Rows, actions: NDArray[np.int64]) -> tuple[_Rows, _Rows]:
        """Returns (N, R) what comes of (N, R) kitchens by (N, 2) joint actions, and (N, 2) what the chefs did."""
        n, after = len(rows), rows.copy()
        taken = np.empty((n, 2), np.uint16)
        if n > self._room:
            self._room = n
            self._image = np.zeros((n, 26 * self._cells), np.uint8)
            self._clock = np.zeros(n, np.int64)
            self._over = np.zeros(n, np.bool_)
        clock = self._clock[:n]
        clock[:] = 0
        step_and_note(
            *(after, clock, self._image[:n], *self._tables, ENDLESS, np.ascontiguousarray(actions)),
            *(np.zeros((2, n, 2)), self._over[:n], None, taken),
        )
        return after, taken


class Answers:
    """A partner's actions in each state of a layer; it is asked once for all states that look the same to it."""

    def __init__(self, partner: "Behaviour", layout: Layout, tables: Tables, seat: int, scratch: Batch) -> None:
        self._partner, self._layout, self._tables, self._seat, self._scratch = partner, layout, tables, seat, scratch
        sight, width = partner.sight, layout.width
        seen = {POSITION + seat, FACING + seat, HELD + seat}
        seen |= {POSITION + 1 - seat} if sight.partner else set()
        seen |= {FACING + 1 - seat} if sight.partner_facing else set()
        cells = (*(layout.positions("P") if sight.pots else ()), *sight.counters)
        self._columns = sorted(seen | {CELLS + y * width + x for x, y in cells})
        self._known: dict[tuple[int, bytes], int] = {}

    def joint(self, rows: _Rows, seat: int, t: int) -> NDArray[np.int64]:
        """Returns (N x 6, 2) joint actions: each of chef A's six with the partner's, in the order of the seats."""
        looks = np.ascontiguousarray(rows[:, self._columns])
        phase = self._partner.phase(t)
        keys = looks.view(f"V{2 * looks.shape[1]}").ravel().tolist()
        for i, key in enumerate(keys):
            if (phase, key) not in self._known:
                self._scratch.rows[0] = rows[i]
                state = read_state(self._scratch, self._tables, self._layout, 0)
                self._known[phase, key] = self._partner.act(self._layout, state, self._seat, t)
        answers = [self._known[phase, key] for key in keys]
        joint = np.empty((len(rows) * NUM_ACTIONS, 2), np.int64)
        joint[:, seat] = np.tile(np.arange(NUM_ACTIONS), len(rows))
        joint[:, 1 - seat] = np.repeat(answers, NUM_ACTIONS)
        return joint


def _joined(
    kept: list[tuple[_Rows, _Rows, NDArray[np.int64]]],
) -> tuple[_Rows, _Rows, NDArray[np.int64]]:
    rows, counts, chosen = zip(*kept, strict=True)
    return np.concatenate(rows), np.concatenate(counts), np.concatenate(chosen)


def _trace(layers: list[tuple[NDArray[np.int64], NDArray[np.int64]]], number: int, seat: int) -> Found:
    """Traces the actions from a state of the last layer back to the start."""
    played = []
    for sources, joint in reversed(layers):
        played.append(joint[number])
        number = int(sources[number]) // NUM_ACTIONS
    played.reverse()
    return Found(tuple(int(j[seat]) for j in played), tuple(int(j[1 - seat]) for j in played))


@lru_cache(64)
def _compiled(layout: Layout, cooking: str) -> Tables:
    return compile_tables(layout, cooking)
