"""Changes a planner's errands by its habits: which job it takes, and where it passes objects on.

Axes: B rows, C cells.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.planner.errands import DISH_COURIER, ONION_COURIER
from overcooked_bench.agents.planner.facts import (
    ACTIVE,
    AT,
    BEST,
    COOKS,
    ERRAND,
    GOAL,
    HAND,
    INSISTS,
    ME,
    NEED,
    PARTNER,
    PARTNER_COOKS,
    PARTNER_HAND,
    PASS_AT,
    ROLE,
    SAME,
    SOONEST,
    SOUPS,
    USE,
    WAIT,
    Facts,
    Table,
    item_at,
)
from overcooked_bench.agents.planner.habits import HabitTables, Job
from overcooked_bench.agents.planner.tables import DISH, FAR, NOTHING, ONION, PASSES, REGION, SOUP
from overcooked_bench.kitchen.jit import jit

_SOON: Final = 2  # missing ingredients at which an early dish is fetched
# Steps until a soup is ready at which a chef in a region of its own fetches a dish.
_NEARLY: Final = {"early": 8, "dish": 14}


def take_jobs(facts: Facts, role: int, job: Job) -> None:
    """Sets ROLE: that of the planner, or a courier's where its job is done by habit and the partner can do the rest.

    Args:
        facts: (B, FACTS), as `trust` leaves them.
        role: GREEDY, ONION_COURIER or DISH_COURIER.
        job: See `Habits.job`.
    """
    facts[:, ROLE] = role
    if not job:
        return
    hand, theirs = facts[:, HAND], facts[:, PARTNER_HAND]
    shares = (facts[:, [INSISTS, ACTIVE, COOKS, PARTNER_COOKS]] > 0).all(axis=1)
    if job == "food":
        facts[shares & (hand < DISH), ROLE] = ONION_COURIER
    else:
        shares &= (job == "dish") | (facts[:, SOUPS] > 0) | (facts[:, NEED] <= _SOON)
        shares &= (facts[:, SAME] > 0) | (facts[:, SOONEST] <= _NEARLY[job])
        first = (theirs != DISH) | ((hand == DISH) & (facts[:, ME] > facts[:, PARTNER]))
        facts[shares & first & ((hand == NOTHING) | (hand >= DISH)), ROLE] = DISH_COURIER


def find_passes(views: NDArray[np.uint8], tables: HabitTables, steps: Table, facts: Facts) -> None:
    """Sets PASS_AT, the counter to pass the held object over or -1, and finds where to take objects that were passed.

    Args:
        views: (B, 26, C) observations.
        tables: Those of the layout and the habits.
        steps: (B, C) steps to each cell.
        facts: (B, FACTS), as `weigh` leaves them.
    """
    mine = tables.plan.onward[tables.plan.grid[REGION, facts[:, ME]]]
    facts[:, PASS_AT] = -1
    rows = np.flatnonzero((facts[:, [SAME, INSISTS]] > 0).all(axis=1))
    _find_passes(rows, views, steps, mine, tables.customs, tables.takes, facts)


@jit
def _find_passes(
    rows: NDArray[np.int64],
    views: NDArray[np.uint8],
    steps: Table,
    onward: Table,
    customs: Table,
    takes: Table,
    facts: Facts,
) -> None:
    for row in rows:
        view, f = views[row], facts[row]
        for item in range(ONION, SOUP):
            needed = f[SOUPS] if item == DISH else f[NEED]
            lie, put, put_at, take, take_at = 0, FAR, -1, FAR, -1
            for c in range(views.shape[2]):
                if customs[item, c] != PASSES:
                    continue
                lies, further = item_at(view, c), onward[row, item, c]
                if lies == NOTHING and steps[row, c] + further < put:
                    put, put_at = steps[row, c] + further, c
                elif lies == item:
                    lie += 1
                    for k in range(4):
                        n = takes[k, c]
                        if n >= 0 and steps[row, n] + further < take:
                            take, take_at = steps[row, n] + further, c
            fetch, at = f[BEST + item], f[AT + item]
            fetch = min(fetch, steps[row, at] + 1) if put_at >= 0 and at >= 0 else fetch
            if take_at >= 0 and (take < fetch or lie >= needed):
                f[BEST + item], f[AT + item] = take, take_at
            if f[HAND] == item and lie < needed and put + 1 < onward[row, item, f[ME]]:
                f[PASS_AT] = put_at


@jit
def approach(steps: Table, customs: Table, takes: Table, facts: Facts) -> None:
    """Turns GOAL to the counter to pass an object over, or to the side of a counter where passed objects are taken."""
    for row in range(facts.shape[0]):
        f = facts[row]
        if f[PASS_AT] >= 0 and (f[ERRAND] == USE or (f[ERRAND] == WAIT and f[HAND] == DISH)):
            f[GOAL] = f[PASS_AT]
        elif f[GOAL] >= 0 and f[INSISTS] and f[SAME] and ONION <= f[ERRAND] < SOUP:
            if customs[f[ERRAND], f[GOAL]] != PASSES:
                continue
            c, best = f[GOAL], FAR
            for k in range(4):
                n = takes[k, c]
                if n == f[ME]:
                    f[GOAL], best = c, -1
                elif n >= 0 and steps[row, n] < best:
                    best, f[GOAL] = steps[row, n], n
