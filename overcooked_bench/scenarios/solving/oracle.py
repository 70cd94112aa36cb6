"""An honest planner: it knows the goal, and of its partner only the past actions.

If the solver passes a scenario and this planner fails, the scenario requires mind-reading.
"""

from collections import deque
from collections.abc import Collection
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.behaviours.behaviour import Behaviour
from overcooked_bench.agents.behaviours.helping import helper
from overcooked_bench.agents.behaviours.jobs import Job, carry, dumper, receiver
from overcooked_bench.agents.behaviours.timed import FROZEN, Loop
from overcooked_bench.kitchen.codes import DIRECTIONS, NUM_ACTIONS, STAY, Position
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.scenarios.language.terms import Compare, Condition, Count, Either
from overcooked_bench.scenarios.solving.search import Search, TooManyStates
from overcooked_bench.scenarios.solving.solver import search_for

if TYPE_CHECKING:
    from overcooked_bench.scenarios.scenario import Situation

_MOST_STATES: Final = 50_000
"""States of one search; what needs more is not seen."""

_CLUTTER: Final = 2  # things more on counters than there are now, above which one does not look further

_PATIENCE: Final = 4  # steps until one thinks again about a guess that led nowhere

_ROUND: Final = 2  # steps after which a partner is thought to do the same again


class Play(NamedTuple):
    """The honest planner's result.

    Attributes:
        passed: Whether the goal was reached within the budget.
        actions: Chef A's actions, up to the verdict.
    """

    passed: bool
    actions: tuple[int, ...]


def play_honestly(situation: "Situation", budget: int) -> Play:
    """Plays a situation without knowing the partner's behaviour.

    Args:
        situation: A scenario from one seat.
        budget: Steps.
    """
    search, behaviour = search_for(situation), situation.behaviour
    oracle = Oracle(situation.layout, search, situation.seat, situation.accept, situation.state.objects)
    row, counts = search.row(situation.state), search.no_counts()
    for joint in situation.before:
        before, (row, _) = row, search.step(row, counts, joint)
        oracle.watch(before, joint[situation.seat], row)
    actions: list[int] = []
    for t in range(budget + 1):
        reached, lost = search.judge(row[None], counts[None])
        if reached[0] or lost[0] or t == budget:
            return Play(bool(reached[0]), tuple(actions))
        actions.append(oracle.act(row, counts, budget - t))
        own, other = actions[-1], search.answer(row, behaviour, t)
        before, (row, counts) = row, search.step(row, counts, (own, other) if situation.seat == 0 else (other, own))
        oracle.watch(before, actions[-1], row)
    raise AssertionError("the loop ends by its return")


class Oracle:
    """Plans again whenever its partner deviates from the prediction.

    It keeps a list of behaviours, and predicts with the one that has explained the partner's past for the longest time
    up to now, the simplest one in a tie; if the goal cannot be reached that way, with the next one.

    Args:
        layout: The kitchen's.
        search: The search for the goal.
        seat: Chef A's seat.
        accept: What has to hold.
        used: Counters with objects on them at the start.
    """

    def __init__(
        self, layout: Layout, search: Search, seat: int, accept: Condition, used: Collection[Position]
    ) -> None:
        self._search, self._seat = search, seat
        self._guesses = guesses(layout, used)
        self._explained = [0] * (len(self._guesses) + 1)  # the last one for doing the same again
        self._vain: dict[int, tuple[int, bool]] = {}  # steps since a guess led nowhere, and whether it still does not
        self._past: list[int] = []  # the partner's actions, as far as they can be seen
        self._needs_partner = not _alone(accept)
        self._plan: deque[tuple[int, NDArray[np.uint16]]] = deque()

    def watch(self, before: NDArray[np.uint16], own: int, after: NDArray[np.uint16]) -> None:
        """Records what the partner did.

        Args:
            before: The kitchen's row.
            own: The own action.
            after: The row that came of both actions.
        """
        outcomes = [self._outcome(before, own, action) for action in range(NUM_ACTIONS)]
        fitting = [action for action in (STAY, *range(NUM_ACTIONS)) if np.array_equal(outcomes[action], after)]
        for number, guess in enumerate(self._guesses):
            guessed = self._search.answer(before, guess, 0)
            self._note(number, guessed in fitting)
        self._past.append(fitting[0])
        self._note(-1, len(self._past) > _ROUND and self._past[-1] == self._past[-1 - _ROUND])

    def _note(self, number: int, fits: bool) -> None:
        self._explained[number] = self._explained[number] + 1 if fits else 0
        if number in self._vain:
            age, proven = self._vain[number]
            # While a guess explains what happens, it goes on not to lead there.
            self._vain[number] = age + 1, proven and fits
            if age + 1 >= _PATIENCE and not (proven and fits):
                del self._vain[number]

    def act(self, row: NDArray[np.uint16], counts: NDArray[np.uint16], left: int) -> int:
        """Chooses an action.

        Args:
            row: The kitchen's row.
            counts: What has happened so far.
            left: Steps until the end.
        """
        if not (self._plan and np.array_equal(self._plan[0][1], row)):
            self._plan = self._think(row, counts, left)
        return self._plan.popleft()[0] if self._plan else STAY

    def _think(
        self, row: NDArray[np.uint16], counts: NDArray[np.uint16], left: int
    ) -> deque[tuple[int, NDArray[np.uint16]]]:
        for number, guess in self._ranked():
            refuted = bool(self._past) and self._explained[number] == 0 and isinstance(guess, Job)
            if refuted or number in self._vain or (self._needs_partner and guess is FROZEN):
                continue
            found, proven = None, True
            try:
                found = self._search.run(row, counts, guess, 0, left, _MOST_STATES, _CLUTTER)
            except TooManyStates:
                proven = False
            if found:
                plan: deque[tuple[int, NDArray[np.uint16]]] = deque()
                for own, other in zip(found.actions, found.partner, strict=True):
                    plan.append((own, row))
                    row = self._outcome(row, own, other)
                return plan
            self._vain[number] = 0, proven
        return deque()

    def _ranked(self) -> list[tuple[int, Behaviour]]:
        """Lists what the partner may be doing, the likeliest first."""
        likely = sorted(enumerate(self._guesses), key=lambda entry: -self._explained[entry[0]])
        past = self._past[-_ROUND:]
        if len(past) == _ROUND and set(past) != {STAY}:
            steps = _ROUND + self._explained[-1]
            place = sum(self._explained[number] >= steps for number, _ in likely)
            likely.insert(place, (-1, Loop(tuple(past))))
        return likely

    def _outcome(self, row: NDArray[np.uint16], own: int, other: int) -> NDArray[np.uint16]:
        joint = [own, other] if self._seat == 0 else [other, own]
        return self._search.step(row, self._search.no_counts(), joint)[0]


def guesses(layout: Layout, used: Collection[Position]) -> tuple[Behaviour, ...]:
    """Lists what an unknown partner may be doing, the simplest first.

    Args:
        layout: The kitchen's.
        used: Counters with objects on them; objects may also be passed over counters with floor on two sides.
    """
    floor = set(layout.positions(" "))
    sides = {(x, y): sum((x + dx, y + dy) in floor for dx, dy in DIRECTIONS) for x, y in layout.positions("X")}
    passed = tuple(cell for cell in sides if sides[cell] > 1)
    counters = tuple(cell for cell in sides if sides[cell] > 1 or cell in used)
    return (
        FROZEN,
        Job(carry, "insist"),
        *((Job(receiver, "insist", counters),) if counters else ()),
        *(Job(dumper, "insist", passed, item) for item in ("onion", "dish") if passed),
        Job(helper, "insist", counters),
        Job(carry, "polite"),
        Job(helper, "polite", counters),
        Job(carry, "yield"),
        Job(helper, "yield", counters),
    )


def _alone(accept: Condition) -> bool:
    """Returns whether the goal can be reached while the partner stands still."""
    if isinstance(accept, Either):
        return any(_alone(condition) for condition in accept.conditions)
    return not any(
        isinstance(part, Compare)
        and isinstance(part.left, Count)
        and part.left.counter.chef == "B"
        and part.operator in (">=", ">", "==")
        and str(part.right) != "0"
        for part in accept.conjuncts
    )
