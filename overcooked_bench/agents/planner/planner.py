"""The planner: one agent for `greedy` and the two couriers, which differ in the jobs that they do.

Axes: B rows (simultaneous episodes), H x W the grid.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.draws import uniforms
from overcooked_bench.agents.planner.habits import NO_HABITS, Habits, make_habit_tables
from overcooked_bench.kitchen.codes import STAY
from overcooked_bench.kitchen.layout import Layout

ROLES: Final = ("greedy", "onion_courier", "dish_courier")
"""In the order of the roles of `errands`."""

_SEAT_SALT: Final = 0x5851F42D4C957F2D  # keeps two copies with the same seeds apart
_PAUSE_SALT: Final = 0x2545F4914F6CDD1D  # keeps pauses apart from other draws


class Planner:
    """Walks shortest paths to what is most useful now, given both chefs' hands and the objects in the kitchen.

    Args:
        role: "greedy" does every job; "onion_courier" puts ingredients into pots and never plates; "dish_courier" waits
            for soups, plates and serves them and never fills pots. All start full pots if the cooking mode needs it.
        layout: A shipped name, a grid's text, a file or a Layout; its orders are cooked as long as `reset` names the
            same layout.
        habits: What it prefers where several ways of working together would do; none by default.

    Raises:
        LayoutError: No such layout.
    """

    observation = "lossless26"

    def __init__(self, role: str, layout: str | Layout, habits: Habits = NO_HABITS) -> None:
        self._role, self._habits = ROLES.index(role), habits
        self._layout = Layout.load(layout)
        self._tables = make_habit_tables(self._layout, self._habits)
        self._seeds: NDArray[np.uint64] = np.zeros(0, np.uint64)
        self._step = 0

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts new episodes.

        Raises:
            LayoutError: No such layout.
        """
        from overcooked_bench.agents.planner.facts import FACTS

        if layout != self._layout.name:
            self._layout = Layout.load(layout)
            self._tables = make_habit_tables(self._layout, self._habits)
        self._seeds = np.asarray(seeds, np.uint64) + np.asarray(seats, np.uint64) * np.uint64(_SEAT_SALT)
        self._step = 0
        self._facts = np.zeros((len(self._seeds), FACTS), np.int64)

    def act(self, observations: NDArray[np.uint8]) -> NDArray[np.int64]:
        """Chooses one action per row.

        Args:
            observations: (B, 26, H, W) uint8.

        Raises:
            ValueError: The shape does not fit the rows and the layout of `reset`.
        """
        from overcooked_bench.agents.planner.customs import approach, find_passes, take_jobs
        from overcooked_bench.agents.planner.errands import choose
        from overcooked_bench.agents.planner.facts import TRIED, look, trust
        from overcooked_bench.agents.planner.steering import walk
        from overcooked_bench.agents.planner.weighing import weigh

        layout, facts, habits, tables = self._layout, self._facts, self._habits, self._tables
        wanted = (len(self._seeds), 26, layout.height, layout.width)
        if observations.shape != wanted:
            raise ValueError(f"observations have the shape {observations.shape}; reset() announced {wanted}")
        views = np.ascontiguousarray(observations, np.uint8).reshape(*wanted[:2], -1)
        look(views, facts)
        steps = weigh(views, tables.plan, tables.customs, facts)
        if habits.passes:
            find_passes(views, tables, steps, facts)
        trust(facts)
        take_jobs(facts, self._role, habits.job)
        choose(facts)
        if habits.passes:
            approach(steps, tables.customs, tables.takes, facts)
        actions = walk(tables.plan, uniforms(self._seeds, self._step), facts)
        if habits.pause > 0:
            pauses = uniforms(self._seeds ^ np.uint64(_PAUSE_SALT), self._step) < habits.pause
            actions[pauses], facts[pauses, TRIED] = STAY, 0
        self._step += 1
        return actions
