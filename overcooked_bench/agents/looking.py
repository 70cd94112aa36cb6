"""What a scripted planner takes from its observation: who is where, what the pots need, and where everything is got.

Axes: B rows (simultaneous episodes), C cells. All that is known of a row is one row of `facts`, (B, FACTS) int64, by the
indices below. Compiled code is kept short and flat here: every line costs time at the first call.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.planning import (
    COUNTER,
    DISH,
    FAR,
    FLAGS,
    FLOOR,
    NOTHING,
    ONION,
    ONIONS,
    POT,
    REGION,
    SERVING,
    SOUP,
    TILE,
    TOMATO,
    WAITING,
)
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.observations import CHANNELS

Facts = NDArray[np.int64]
Table = NDArray[np.int64]

# What is seen.
ME, FACING, HAND, MATE, MATE_FACING, MATE_HAND = range(6)
# What is remembered: own last cell and the one before, and whether a step was tried; steps of no advance; how the mate
# and the pots were, and for how many steps; how often patience ran out; steps yet to keep out of the mate's way; steps
# yet to go straight (above 0) or round (below 0).
LAST_CELL, CELL_BEFORE, TRIED, STUCK, MATE_WAS, IDLE, POTS_WERE, STALE, STRIKES, YIELDING, RESOLVED = range(6, 17)
# What the pots need: all missing ingredients, which (bits), soups under way, steps until the first is ready.
POTS_NOW, NEED, BITS, SOUPS, SOONEST = range(17, 22)
# Counters between the two chefs' regions: how many, how many free, how many carry food, a dish.
SHARED, ROOM, FOODS, DISHES = range(22, 26)
# Whether both are in one region, one reaches a pot, the mate does, one reaches a serving tile; whether to count on the
# mate at all, on its dish, on its food; the tile to work at, or -1; steps to the tile in `USE`; steps that a way through
# the mate counts more.
SAME, COOKS, MATE_COOKS, SERVES, ACTIVE, MATE_DISH, MATE_FOOD, GOAL, USE_STEPS, THROUGH = range(26, 36)
# Errands: the items 1 to 4 to fetch; to wait; to bring what is held; to start a pot; to hand over; to put down; to clear
# a shared counter. For each the steps of the best way, of the mate's best way, and the tile.
WAIT, USE, START, HAND_OVER, PUT_DOWN, CLEAR, ERRANDS = 0, 5, 6, 7, 8, 9, 10
BEST: Final = 36
MATES: Final = BEST + ERRANDS
AT: Final = MATES + ERRANDS
FACTS: Final = AT + ERRANDS

LATE: Final = FAR // 2  # steps left of a soup that waits to be started
PATIENCE: Final = 30  # steps without any change in a pot after which the mate is not counted on; less with every strike
LEAST_PATIENCE: Final = 8
IDLE_LONG, IDLE_VERY_LONG, ASK_AGAIN = 8, 24, 120  # steps: no help; a wall; until one tries again whether it is
DETOUR: Final = 4  # steps of a way round that one takes rather than wait for the mate to leave
FULLER: Final = 2  # steps of a way that an ingredient less to bring is worth
NOT_SHARED: Final = 50  # steps that one goes not to lay things in the way on a shared counter

_OWN, _OTHER = CHANNELS.index("own_position"), CHANNELS.index("other_position")
_OWN_NORTH, _OTHER_NORTH = CHANNELS.index("own_faces_north"), CHANNELS.index("other_faces_north")
_IN_POT, _IN_SOUP = CHANNELS.index("onions_in_pot"), CHANNELS.index("onions_in_soup")  # tomatoes follow
_REMAINING, _DONE = CHANNELS.index("cook_time_remaining"), CHANNELS.index("soup_done")
_DISH, _ONION, _TOMATO = CHANNELS.index("dishes"), CHANNELS.index("onions"), CHANNELS.index("tomatoes")


@jit
def look(views: NDArray[np.uint8], grid: Table, facts: Facts) -> None:
    """Finds the chefs and what they hold, and compares with the last step; views (B, 26, C), grid as in `Plan`."""
    for row in range(views.shape[0]):
        view, f = views[row], facts[row]
        for c in range(views.shape[2]):
            if view[_OWN, c] or view[_OTHER, c]:
                first, faces = (ME, _OWN_NORTH) if view[_OWN, c] else (MATE, _OTHER_NORTH)
                f[first] = c
                f[first + 1] = view[faces + 1, c] + 2 * view[faces + 2, c] + 3 * view[faces + 3, c]
                item = view[_ONION, c] + 2 * view[_TOMATO, c] + 3 * view[_DISH, c] + 4 * view[_DONE, c]
                f[first + 2] = item
        back = f[ME] == f[LAST_CELL] or f[ME] == f[CELL_BEFORE]
        f[STUCK] = f[STUCK] + 1 if f[TRIED] and back else max(0, f[STUCK] - 1)
        mate = (f[MATE] * 4 + f[MATE_FACING]) * 8 + f[MATE_HAND]
        f[IDLE] = f[IDLE] + 1 if f[MATE_WAS] == mate else 0
        f[CELL_BEFORE], f[LAST_CELL], f[MATE_WAS], f[TRIED] = f[LAST_CELL], f[ME], mate, 0
        f[YIELDING] = max(0, f[YIELDING] - 1)
        f[RESOLVED] -= (f[RESOLVED] > 0) - (f[RESOLVED] < 0)


@jit
def tally(
    views: NDArray[np.uint8], grid: Table, ways: Table, around: Table, onward: Table, wanted: Table, facts: Facts
) -> None:
    """Sums up what the pots need and finds the best tile for each errand; tables as in `Plan`."""
    for row in range(views.shape[0]):
        view, f = views[row], facts[row]
        me, mate, hand = f[ME], f[MATE], f[HAND]
        mine = onward[grid[REGION, me]]
        passing = around[mate if around.shape[0] > 1 else 0]
        for k in range(POTS_NOW, BEST):
            f[k] = 0
        for e in range(ERRANDS):
            f[BEST + e], f[MATES + e], f[AT + e] = FAR, FAR, -1
        f[SAME], f[COOKS], f[SERVES] = ways[me, mate] < FAR, mine[FLAGS, 0], mine[FLAGS, 1]
        f[SOONEST] = FAR
        f[THROUGH] = DETOUR if f[IDLE] < IDLE_LONG else FAR if f[IDLE] % ASK_AGAIN >= IDLE_VERY_LONG else 10 * DETOUR
        for c in range(views.shape[2]):
            tile = grid[TILE, c]
            steps, mates = min(passing[me, c], ways[me, c] + f[THROUGH]), ways[mate, c]
            errand, extra, item = -1, 0, NOTHING
            if tile == FLOOR:
                errand, extra = WAIT, mine[WAITING, c] + (FAR if c == mate else 0)
            elif tile == COUNTER:
                item = view[_ONION, c] + 2 * view[_TOMATO, c] + 3 * view[_DISH, c] + 4 * view[_DONE, c]
                shared = steps < FAR and mates < FAR and not f[SAME]
                if shared:
                    f[SHARED] += 1
                    f[ROOM] += item == NOTHING
                    f[FOODS] += item == ONION or item == TOMATO
                    f[DISHES] += item == DISH
                    if item == NOTHING and steps < f[BEST + HAND_OVER]:
                        f[BEST + HAND_OVER], f[AT + HAND_OVER] = steps, c
                    if (item == ONION or item == TOMATO) and steps < f[BEST + CLEAR]:
                        f[BEST + CLEAR], f[AT + CLEAR] = steps, c
                    if not f[COOKS] and item != SOUP:
                        item = -1
                if item == NOTHING:
                    errand, extra = PUT_DOWN, NOT_SHARED * shared
            elif tile >= ONIONS:
                item = tile - ONIONS + ONION
            elif tile == SERVING and hand == SOUP:
                errand = USE
            elif tile == POT and (steps if f[COOKS] else mates) < FAR:
                f[MATE_COOKS] |= mates < FAR
                bits = 1 << DISH
                if view[_IN_SOUP, c] + view[_IN_SOUP + 1, c] > 0:
                    left = np.int64(view[_REMAINING, c])
                    f[POTS_NOW] = (f[POTS_NOW] * 131 + 100 + left) & 0xFFFFFFFF
                else:
                    onions, tomatoes = np.int64(view[_IN_POT, c]), np.int64(view[_IN_POT + 1, c])
                    f[POTS_NOW] = (f[POTS_NOW] * 131 + onions * 4 + tomatoes) & 0xFFFFFFFF
                    onions, tomatoes = wanted[onions, tomatoes, 0] - onions, wanted[onions, tomatoes, 1] - tomatoes
                    left = LATE
                    if onions + tomatoes > 0:
                        bits = (onions > 0) << ONION | (tomatoes > 0) << TOMATO
                        f[NEED] += onions + tomatoes
                        f[BITS] |= bits
                        extra = FULLER * (onions + tomatoes)
                    elif steps < f[BEST + START]:
                        f[BEST + START], f[AT + START], f[MATES + START] = steps, c, mates
                if bits == 1 << DISH:
                    f[SOUPS] += 1
                    f[SOONEST] = min(f[SOONEST], left)
                    extra = max(0, left - steps)
                    mates = max(mates, left) - extra
                if bits >> hand & 1:
                    errand = USE
            if item > NOTHING:
                errand, extra = item, mine[item, c]
            if errand >= 0:
                f[MATES + errand] = min(f[MATES + errand], mates + extra)
                if steps + extra < f[BEST + errand]:
                    f[BEST + errand], f[AT + errand] = steps + extra, c
                    if errand == USE:
                        f[USE_STEPS] = steps


@jit
def trust(facts: Facts) -> None:
    """Judges whether the mate can be counted on, by whether it stirs and whether the pots advance."""
    for row in range(facts.shape[0]):
        f = facts[row]
        f[STALE] = f[STALE] + 1 if f[POTS_WERE] == f[POTS_NOW] else 0
        f[POTS_WERE] = f[POTS_NOW]
        patience = max(LEAST_PATIENCE, PATIENCE >> f[STRIKES])
        if f[STALE] == patience:
            f[STRIKES] = min(f[STRIKES] + 1, 2)
        trusted = f[STALE] < patience
        f[ACTIVE] = trusted and f[IDLE] < IDLE_LONG
        waits = trusted and (f[IDLE] < IDLE_LONG or f[STALE] < 3)
        f[MATE_DISH] = waits and f[MATE_COOKS] and f[MATE_HAND] == DISH
        f[MATE_FOOD] = f[ACTIVE] and f[MATE_COOKS] and (f[MATE_HAND] == ONION or f[MATE_HAND] == TOMATO)
