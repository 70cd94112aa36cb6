"""Computes the needs of the pots, the objects in the kitchen, and the best tile for each errand of a scripted planner.

Axes: B rows, C cells. Shared by all: `steps` and `partner_steps` (B, C), the steps of this chef and of the partner to
each cell; `grid` and `onward` as in `LayoutTables`.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.planner.facts import (
    AT,
    BEST,
    BITS,
    CLEAR,
    COOKS,
    DISHES,
    FOOD_PLACES,
    FOODS,
    HAND,
    HAND_OVER,
    INSISTS,
    ME,
    NEED,
    PARTNER,
    PARTNER_BEST,
    PARTNER_COOKS,
    POTS_NOW,
    PUT_DOWN,
    ROOM,
    SAME,
    SERVES,
    SHARED,
    SOONEST,
    SOUPS,
    START,
    THROUGH,
    USE,
    USE_STEPS,
    WAIT,
    Facts,
    Table,
    item_at,
)
from overcooked_bench.agents.planner.tables import (
    COUNTER,
    DISH,
    ELSEWHERE,
    FAR,
    FLAGS,
    FLOOR,
    HANDS_OVER,
    NOTHING,
    ONION,
    ONIONS,
    PASSES,
    POT,
    REGION,
    SERVING,
    SOUP,
    TILE,
    TOMATO,
    WAITING,
    LayoutTables,
)
from overcooked_bench.kitchen.image import CHANNELS
from overcooked_bench.kitchen.jit import jit

_LATE: Final = FAR // 2  # remaining steps assumed for a soup that waits to be started
_FULLER: Final = 2  # steps that one missing ingredient less is worth
_NOT_SHARED: Final = 50  # steps accepted to avoid blocking a shared counter

_IN_POT, _IN_SOUP = CHANNELS.index("onions_in_pot"), CHANNELS.index("onions_in_soup")  # tomatoes follow
_REMAINING: Final = CHANNELS.index("cook_time_remaining")


def weigh(views: NDArray[np.uint8], plan: LayoutTables, customs: Table, facts: Facts) -> Table:
    """Computes all facts from POTS_NOW on.

    Args:
        views: (B, 26, C) observations.
        plan: The layout's tables.
        customs: (5, C) by item, see `habits.HabitTables`.
        facts: (B, FACTS), as `look` leaves them.

    Returns:
        (B, C) this chef's steps to each cell.
    """
    me, partner = facts[:, ME], facts[:, PARTNER]
    partner_steps = plan.ways[partner]
    steps: Table = np.minimum(
        plan.around[partner if len(plan.around) > 1 else 0, me], plan.ways[me] + facts[:, THROUGH, None]
    )
    facts[:, POTS_NOW:BEST] = 0
    facts[:, BEST:AT] = FAR
    facts[:, AT:INSISTS] = -1
    facts[:, SAME] = plan.ways[me, partner] < FAR
    facts[:, [COOKS, SERVES]] = plan.onward[plan.grid[REGION, me], FLAGS, :2]
    facts[:, SOONEST] = FAR
    _weigh_pots(views, plan.grid, steps, partner_steps, plan.wanted, facts)
    _weigh_counters(views, plan.grid, steps, partner_steps, customs, facts)
    _weigh_tiles(views, plan.grid, steps, partner_steps, plan.onward, customs, facts)
    return steps


@jit
def _weigh_pots(
    views: NDArray[np.uint8], grid: Table, steps: Table, partner_steps: Table, wanted: Table, facts: Facts
) -> None:
    """Sums up all pots in reach, or else those in the partner's reach; finds where to use the held object."""
    for row in range(views.shape[0]):
        view, f = views[row], facts[row]
        for c in range(views.shape[2]):
            if grid[TILE, c] != POT or (steps[row, c] if f[COOKS] else partner_steps[row, c]) >= FAR:
                continue
            own, other, bits, extra = steps[row, c], partner_steps[row, c], 1 << DISH, np.int64(0)
            f[PARTNER_COOKS] |= other < FAR
            if view[_IN_SOUP, c] + view[_IN_SOUP + 1, c] > 0:
                left, sign = np.int64(view[_REMAINING, c]), 100 + np.int64(view[_REMAINING, c])
            else:
                onions, tomatoes = np.int64(view[_IN_POT, c]), np.int64(view[_IN_POT + 1, c])
                left, sign = np.int64(_LATE), onions * 4 + tomatoes
                onions, tomatoes = wanted[onions, tomatoes, 0] - onions, wanted[onions, tomatoes, 1] - tomatoes
                if onions + tomatoes > 0:
                    bits = (onions > 0) << ONION | (tomatoes > 0) << TOMATO
                    extra = _FULLER * (onions + tomatoes)
                    f[NEED] += onions + tomatoes
                    f[BITS] |= bits
                elif own < f[BEST + START]:
                    f[BEST + START], f[AT + START], f[PARTNER_BEST + START] = own, c, other
            f[POTS_NOW] = (f[POTS_NOW] * 131 + sign) & 0xFFFFFFFF
            if bits == 1 << DISH:
                f[SOUPS] += 1
                f[SOONEST] = min(f[SOONEST], left)
                own, other = max(own, left), max(other, left)
            if bits >> f[HAND] & 1:
                f[PARTNER_BEST + USE] = min(f[PARTNER_BEST + USE], other + extra)
                if own + extra < f[BEST + USE]:
                    f[BEST + USE], f[AT + USE], f[USE_STEPS] = own + extra, c, steps[row, c]


@jit
def _weigh_counters(
    views: NDArray[np.uint8], grid: Table, steps: Table, partner_steps: Table, customs: Table, facts: Facts
) -> None:
    """Finds where objects can be put down or handed over, and counts the objects between two regions."""
    for row in range(views.shape[0]):
        view, f = views[row], facts[row]
        for c in range(views.shape[2]):
            own = steps[row, c]
            if grid[TILE, c] != COUNTER or own >= FAR:
                continue
            item = item_at(view, c)
            errand, shared = PUT_DOWN if item == NOTHING else -1, partner_steps[row, c] < FAR and not f[SAME]
            if shared:
                f[SHARED] += 1
                f[ROOM] += item == NOTHING
                f[FOOD_PLACES] += item == NOTHING and (customs[ONION, c] != ELSEWHERE or not f[INSISTS])
                f[DISHES] += item == DISH
                if item == ONION or item == TOMATO:  # noqa: SIM109  (a tuple costs compile time)
                    f[FOODS] += 1
                    errand = CLEAR
                usual = customs[f[HAND], c] != ELSEWHERE or not f[INSISTS]
                if item == NOTHING and usual and own < f[BEST + HAND_OVER]:
                    f[BEST + HAND_OVER], f[AT + HAND_OVER] = own, c
                own += _NOT_SHARED
            if errand >= 0 and own < f[BEST + errand]:
                f[BEST + errand], f[AT + errand] = own, c


@jit
def _weigh_tiles(
    views: NDArray[np.uint8],
    grid: Table,
    steps: Table,
    partner_steps: Table,
    onward: Table,
    customs: Table,
    facts: Facts,
) -> None:
    """Finds where to take each object on the way to its destination, where to serve and where to wait."""
    for row in range(views.shape[0]):
        view, f = views[row], facts[row]
        mine = onward[grid[REGION, f[ME]]]
        for c in range(views.shape[2]):
            tile, errand, extra = grid[TILE, c], -1, np.int64(0)
            item = tile - ONIONS + ONION
            if tile == COUNTER:
                item = item_at(view, c)
                custom = customs[item, c] if f[INSISTS] else HANDS_OVER
                if custom == (PASSES if f[SAME] else ELSEWHERE) or (
                    item != SOUP and not f[COOKS] and not f[SAME] and partner_steps[row, c] < FAR
                ):
                    item = NOTHING  # it was handed over, will be passed on, or is where nobody looks for it
            if tile == FLOOR and c != f[PARTNER]:
                errand, extra = WAIT, mine[WAITING, c]
            elif tile == SERVING and f[HAND] == SOUP:
                errand = USE
            elif item > NOTHING:
                errand, extra = item, mine[item, c]
            if errand >= 0:
                f[PARTNER_BEST + errand] = min(f[PARTNER_BEST + errand], partner_steps[row, c] + extra)
                if steps[row, c] + extra < f[BEST + errand]:
                    f[BEST + errand], f[AT + errand] = steps[row, c] + extra, c
