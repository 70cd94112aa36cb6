"""Checks that a pair requires memory: that no agent passes both without knowing what happened before.

Two worlds look the same when the agent is asked for the first time, and differ in what their partners will do. As long
as they look the same, an agent that ignores the past does the same in both. The search even lets it know the world from
the first difference on and act optimally: if that does not pass both, no policy of the observation does, and one
that samples its actions passes one of the two in at most half of its runs.

Axes: N states, R columns of a kitchen's row, K counters.
"""

from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.scenarios.solving.search import TOGETHER, Answers, Search

if TYPE_CHECKING:
    from overcooked_bench.scenarios.scenario import Situation

_FAR: Final = 1 << 30
_Rows = NDArray[np.uint16]
_States = tuple[_Rows, _Rows]  # (N, R) and (N, K)


class Unknowing(NamedTuple):
    """A way to reach both goals without knowing which world it is.

    Attributes:
        actions: Actions while the worlds look the same.
        steps: Steps to each goal, these actions included.
    """

    actions: tuple[int, ...]
    steps: tuple[int, int]


def unknowing(first: "Situation", second: "Situation", budgets: tuple[int, int]) -> list[Unknowing]:
    """Lists the best ways through two situations for an agent that does not know which one it is in.

    Args:
        first: A situation.
        second: Another one from the same seat, in which the kitchen looks the same after `before`.
        budgets: Steps in each situation.

    Returns:
        The ways for which no other is as short in both worlds. If there is none, passing both requires memory.

    Raises:
        ValueError: They do not look the same.
    """
    worlds = [_World(situation, budget) for situation, budget in zip((first, second), budgets, strict=True)]
    if first.seat != second.seat or not np.array_equal(worlds[0].start[0], worlds[1].start[0]):
        raise ValueError(f"{first.id} and {second.id} do not look the same when A is asked for the first time")
    trail, partings = _walk_together(worlds)
    needed = [world.needed([parting.states[i] for parting in partings]) for i, world in enumerate(worlds)]
    ways: list[tuple[int, int, int, int]] = []  # steps, and which parting
    for t, parting in enumerate(partings):
        steps = np.stack([needed[i][t] + t for i in range(2)])
        fits = np.flatnonzero((steps <= np.array(budgets)[:, None]).all(axis=0))
        ways += [(int(steps[0, n]), int(steps[1, n]), t, int(parting.sources[n])) for n in fits]
    found: list[Unknowing] = []
    for one, other, t, source in sorted(ways):
        if not found or other < found[-1].steps[1]:
            found.append(Unknowing(_trace(trail[: t - 1], source), (one, other)))
    return found


class _Parting(NamedTuple):
    """The states in which two worlds first look different, or in which one of them is over.

    Attributes:
        sources: (N,) the state of the previous layer and the action that led here, as state * 6 + action.
        states: The states in each world.
    """

    sources: NDArray[np.int64]
    states: tuple[_States, _States]


def _walk_together(worlds: "list[_World]") -> tuple[list[NDArray[np.int64]], list[_Parting]]:
    """Explores all actions in both worlds as long as they look the same.

    Returns:
        For each step the states that still look the same after it, as state * 6 + action; and the partings at each
        time from 0 on.
    """
    states = [(rows[None], counts[None]) for rows, counts in (world.start for world in worlds)]
    empty = states[0][0][:0], states[0][1][:0]
    trail: list[NDArray[np.int64]] = []
    partings = [_Parting(np.zeros(0, np.int64), (empty, (states[1][0][:0], states[1][1][:0])))]
    seen: set[bytes] = set()
    for t in range(min(world.budget for world in worlds)):
        after = [world.children(state, t) for world, state in zip(worlds, states, strict=True)]
        judged = [world.judge(*child) for world, child in zip(worlds, after, strict=True)]
        lost = judged[0][1] | judged[1][1]
        same = (after[0][0] == after[1][0]).all(axis=1) & ~lost & ~judged[0][0] & ~judged[1][0]
        apart = np.flatnonzero(~same & ~lost)
        partings.append(_Parting(apart, (_take(after[0], apart), _take(after[1], apart))))
        keys = [world.keys(child, t + 1) for world, child in zip(worlds, after, strict=True)]
        kept: list[int] = []
        for i in np.flatnonzero(same).tolist():
            key = keys[0][i] + keys[1][i]
            if key not in seen:
                seen.add(key)
                kept.append(i)
        trail.append(np.array(kept, np.int64))
        states = [_take(child, trail[-1]) for child in after]
        if not kept:
            break
    return trail, partings


class _World(Search):
    """One of the two situations."""

    def __init__(self, situation: "Situation", budget: int) -> None:
        goal = (situation.accept, situation.never, situation.counters)
        super().__init__(situation.layout, situation.scenario.cooking, situation.seat, *goal)
        self.budget, self._partner = budget, situation.behaviour
        row, counts = self.row(situation.state), self.no_counts()
        for joint in situation.before:
            row, _ = self.step(row, counts, joint)
        self.start = row, counts
        self._asked = Answers(self._partner, self._layout, self._tables, 1 - self._seat, self._scratch)

    def children(self, states: _States, t: int) -> _States:
        """Returns the states after each of the six actions in N states: N x 6 states."""
        rows, counts = states
        parts = [
            self._spread(rows[k : k + TOGETHER], counts[k : k + TOGETHER], t)
            for k in range(0, max(len(rows), 1), TOGETHER)
        ]
        return np.concatenate([part[0] for part in parts]), np.concatenate([part[1] for part in parts])

    def _spread(self, rows: _Rows, counts: _Rows, t: int) -> _States:
        joint, before = self._asked.joint(rows, self._seat, t), np.repeat(rows, NUM_ACTIONS, axis=0)
        after, taken = self._desk.step(before, joint)
        return after, self.count(after, taken, np.repeat(counts, NUM_ACTIONS, axis=0))

    def keys(self, states: _States, t: int) -> list[bytes]:
        """Returns keys that distinguish states, including the partner's phase."""
        return self._keys(*states, self._partner.phase(t))

    def needed(self, sources: list[_States]) -> list[NDArray[np.int64]]:
        """Returns the fewest steps to the goal from given states, a very large number if it cannot be reached.

        Args:
            sources: The states of time 0, 1, ...
        """
        numbers: dict[bytes, int] = {}
        steps: list[NDArray[np.int64]] = []  # 0 at the goal
        links: list[NDArray[np.int64]] = []  # (N, 6) the numbers of the states that follow
        asked: list[list[int]] = []
        fringe = _take(sources[0], np.arange(0))
        for t in range(self.budget + 1):
            if t < len(sources):
                keys, first = self.keys(sources[t], t), len(numbers)
                asked.append([numbers.setdefault(key, len(numbers)) for key in keys])
                fringe = _joined(fringe, _take(sources[t], _first_of(asked[-1], first)))
            reached, lost = self.judge(*fringe)
            steps.append(np.where(reached, 0, _FAR))
            links.append(np.full((len(reached), NUM_ACTIONS), -1))
            open_ = np.flatnonzero(~reached & ~lost)
            if t < self.budget:
                after, first = self.children(_take(fringe, open_), t), len(numbers)
                following = [numbers.setdefault(key, len(numbers)) for key in self.keys(after, t + 1)]
                links[-1][open_] = np.array(following, np.int64).reshape(-1, NUM_ACTIONS)
                fringe = _take(after, _first_of(following, first))
        distance, all_links = np.concatenate(steps), np.concatenate(links)
        for _ in range(self.budget):
            distance = np.minimum(distance, np.where(all_links < 0, _FAR, distance[all_links]).min(axis=1) + 1)
        return [distance[np.array(numbers_of, np.int64)] for numbers_of in asked]


def _first_of(numbers: list[int], first: int) -> NDArray[np.int64]:
    """Returns the first position of each number from `first` on."""
    places: list[int] = []
    for place, number in enumerate(numbers):
        if number == first + len(places):
            places.append(place)
    return np.array(places, np.int64)


def _joined(one: _States, other: _States) -> _States:
    return np.concatenate([one[0], other[0]]), np.concatenate([one[1], other[1]])


def _take(states: _States, which: NDArray[np.int64]) -> _States:
    return states[0][which], states[1][which]


def _trace(layers: list[NDArray[np.int64]], source: int) -> tuple[int, ...]:
    """Traces the actions from a state x 6 + action back to the start."""
    actions = [source % NUM_ACTIONS]
    for layer in reversed(layers):
        source = int(layer[source // NUM_ACTIONS])
        actions.append(source % NUM_ACTIONS)
    return tuple(reversed(actions))
