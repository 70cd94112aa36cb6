"""The habits of a scripted planner, and what they change on a layout.

Axes: C = H x W cells in row-major order.
"""

from functools import lru_cache
from typing import Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.planner.tables import (
    BESIDE,
    COUNTER,
    DISH,
    ELSEWHERE,
    FAR,
    HANDS_OVER,
    ONION,
    PASSES,
    REGION,
    SOUP,
    TILE,
    TOMATO,
    LayoutTables,
    make_tables,
)
from overcooked_bench.kitchen.codes import DIRECTIONS
from overcooked_bench.kitchen.layout import Layout

Place = Literal["nearest", "top", "middle", "bottom"]
"""A counter between two regions of the floor, by its row among them."""

Job = Literal["", "food", "dish", "early"]
"""What a planner does by habit where both chefs reach the pots: everything; fill pots, and leave plates to the partner;
fetch dishes, plate and serve, and leave filling to the partner; the same once a soup is cooking or nearly so. Where
their regions are separate, chefs fetch dishes only when a soup is nearly ready, as nobody else can use their ways."""

_SAVES: Final = 2  # steps to a pot that passing over a counter must save


class Habits(NamedTuple):
    """What a planner prefers where several ways of working together would do.

    Apart from `turn` and `pause`, it keeps to them while the pots make progress. If they do not, it does whatever is
    most useful until they do.

    Attributes:
        job: See `Job`.
        turn: Which way it walks around the block of counters in the middle, or around the middle of its region: 1
            clockwise as seen from above, -1 anticlockwise, 0 the shorter way.
        food_over: The counter over which ingredients are handed, and from which they are taken, where the floor has
            separate regions.
        dish_over: The same for dishes.
        passes: Whether ingredients and dishes are passed over a counter instead of being carried around it.
        pause: Probability of a step in which it does nothing.
    """

    job: Job = ""
    turn: Literal[-1, 0, 1] = 0
    food_over: Place = "nearest"
    dish_over: Place = "nearest"
    passes: bool = False
    pause: float = 0.0


NO_HABITS: Final = Habits()
"""Those of `greedy` and the couriers: the most useful errand, the shortest way, the nearest counter."""


class HabitTables(NamedTuple):
    """What habits change on a layout.

    Attributes:
        plan: The layout's tables, whose ways follow the preferred turn.
        customs: (5, C) int64  by item and counter: ELSEWHERE, HANDS_OVER or PASSES
        takes: (4, C) int64  the floor cells next to a counter from which passed objects are taken, or -1
    """

    plan: LayoutTables
    customs: NDArray[np.int64]
    takes: NDArray[np.int64]


@lru_cache(maxsize=32)
def make_habit_tables(layout: Layout, habits: Habits) -> HabitTables:
    """Computes the tables of a layout for a planner's habits; cached, so they must not be changed."""
    plan = make_tables(layout, habits.turn) if habits.turn else make_tables(layout)
    customs = np.full((SOUP + 1, plan.grid.shape[1]), HANDS_OVER)
    counters = plan.grid[TILE] == COUNTER
    reach = np.stack([(plan.ways[region] < FAR).any(axis=0) for region in _regions(layout)])
    shared = np.flatnonzero(counters & (reach.sum(axis=0) > 1))
    for item, place in ((ONION, habits.food_over), (TOMATO, habits.food_over), (DISH, habits.dish_over)):
        if place != "nearest" and len(shared):
            usual = shared[{"top": 0, "middle": len(shared) // 2, "bottom": len(shared) - 1}[place]]
            customs[item, shared] = ELSEWHERE
            customs[item, usual] = HANDS_OVER
    takes = np.full((len(DIRECTIONS), len(counters)), -1)
    if habits.passes:
        takes = _taking_sides(plan, counters)
        customs[ONION:SOUP, (takes >= 0).any(axis=0)] = PASSES
    return HabitTables(plan, customs, takes)


def _regions(layout: Layout) -> list[NDArray[np.int64]]:
    """Returns the floor cells of each region."""
    cells = np.array([(y * layout.width + x, region) for (x, y), region in layout.regions.items()])
    return [cells[cells[:, 1] == region, 0] for region in np.unique(cells[:, 1])]


def _taking_sides(plan: LayoutTables, counters: NDArray[np.bool_]) -> NDArray[np.int64]:
    """Finds the floor cells nearest to the pots beside each counter that is worth passing over, (4, C), else -1."""
    takes = np.full((len(DIRECTIONS), len(counters)), -1)
    for c in np.flatnonzero(counters):
        direction, beside = np.nonzero(plan.grid[BESIDE : BESIDE + len(DIRECTIONS)] == c)
        regions = plan.grid[REGION, beside]
        steps = plan.onward[regions, ONION, beside]
        if len(set(regions)) == 1 and steps.max() < FAR and steps.max() - steps.min() >= _SAVES:
            nearest = steps == steps.min()
            takes[direction[nearest], c] = beside[nearest]
    return takes
