"""What a scripted planner knows of a moment, and what it sees of the two chefs.

Axes: B rows (simultaneous episodes), C cells. All that is known of a row is one row of `facts`, (B, FACTS) int64, by
the indices below. Compiled code is kept short and flat: every line, and every call inside it, costs time at first use.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.planner.tables import DISH, FAR, ONION, TOMATO
from overcooked_bench.kitchen.image import CHANNELS
from overcooked_bench.kitchen.jit import jit

Facts = NDArray[np.int64]
Table = NDArray[np.int64]

# What is seen.
ME, FACING, HAND, MATE, MATE_FACING, MATE_HAND = range(6)
# What is remembered: own last cell and the one before, and whether a step was tried; steps of no advance; how the mate
# and the pots were, and for how many steps; how often patience ran out; steps yet to keep out of the mate's way; steps
# yet to go straight (above 0) or round (below 0); steps that a way through the mate counts more.
LAST_CELL, CELL_BEFORE, TRIED, STUCK, MATE_WAS, IDLE = range(6, 12)
POTS_WERE, STALE, STRIKES, YIELDING, RESOLVED, THROUGH = range(12, 18)
# What the pots need: all missing ingredients, which (bits), soups under way, steps until the first is ready.
POTS_NOW, NEED, BITS, SOUPS, SOONEST = range(18, 23)
# Counters between the two chefs' regions: how many, how many free, how many carry food, a dish.
SHARED, ROOM, FOODS, DISHES = range(23, 27)
# Whether both are in one region, one reaches a pot, the mate does, one reaches a serving tile; whether to count on the
# mate at all, on its dish, on its food.
SAME, COOKS, MATE_COOKS, SERVES, ACTIVE, MATE_DISH, MATE_FOOD = range(27, 34)
# Dishes and ingredients that nobody brings yet; whether an ingredient has room, and whether to start a pot oneself.
DISHES_WANTED, FOOD_WANTED, FOOD_ROOM, STARTS = range(34, 38)
# The errand, the tile to work at, or -1, steps to the tile in `USE`; the action, the floor cell it leads to, or -1.
ERRAND, GOAL, USE_STEPS, ACTION, AHEAD = range(38, 43)
# Errands: the items 1 to 4 to fetch; to wait; to bring what is held; to start a pot; to hand over; to put down; to
# clear a shared counter. For each the steps of the best way, of the mate's best way, and the tile.
WAIT, USE, START, HAND_OVER, PUT_DOWN, CLEAR, ERRANDS = 0, 5, 6, 7, 8, 9, 10
BEST: Final = 43
MATES: Final = BEST + ERRANDS
AT: Final = MATES + ERRANDS
FACTS: Final = AT + ERRANDS

PATIENCE: Final = 30  # steps without any change in a pot after which the mate is not counted on; less with every strike
LEAST_PATIENCE: Final = 8
IDLE_LONG, IDLE_VERY_LONG, ASK_AGAIN = 8, 24, 120  # steps: no help; a wall; until one tries again whether it is
DETOUR: Final = 4  # steps of a way round that one takes rather than wait for the mate to leave

_OWN, _OTHER = CHANNELS.index("own_position"), CHANNELS.index("other_position")
_OWN_NORTH, _OTHER_NORTH = CHANNELS.index("own_faces_north"), CHANNELS.index("other_faces_north")
_ITEMS = tuple(CHANNELS.index(name) for name in ("onions", "tomatoes", "dishes", "soup_done"))


@jit
def item_at(view: NDArray[np.uint8], c: int) -> np.int64:
    """Gives the item on a counter or in a chef's hands at a cell; view (26, C)."""
    item: np.int64 = view[_ITEMS[0], c] + 2 * view[_ITEMS[1], c] + 3 * view[_ITEMS[2], c] + 4 * view[_ITEMS[3], c]
    return item


@jit
def look(views: NDArray[np.uint8], facts: Facts) -> None:
    """Finds the chefs in (B, 26, C) observations, with what they hold, and compares with the last step."""
    for row in range(views.shape[0]):
        view, f = views[row], facts[row]
        for c in range(views.shape[2]):
            if view[_OWN, c] or view[_OTHER, c]:
                first, faces = (ME, _OWN_NORTH) if view[_OWN, c] else (MATE, _OTHER_NORTH)
                f[first] = c
                f[first + 1] = view[faces + 1, c] + 2 * view[faces + 2, c] + 3 * view[faces + 3, c]
                f[first + 2] = item_at(view, c)
        back = f[ME] == f[LAST_CELL] or f[ME] == f[CELL_BEFORE]
        f[STUCK] = f[STUCK] + 1 if f[TRIED] and back else max(0, f[STUCK] - 1)
        mate = (f[MATE] * 4 + f[MATE_FACING]) * 8 + f[MATE_HAND]
        f[IDLE] = f[IDLE] + 1 if f[MATE_WAS] == mate else 0
        f[CELL_BEFORE], f[LAST_CELL], f[MATE_WAS], f[TRIED] = f[LAST_CELL], f[ME], mate, 0
        f[YIELDING] = max(0, f[YIELDING] - 1)
        f[RESOLVED] -= (f[RESOLVED] > 0) - (f[RESOLVED] < 0)
        f[THROUGH] = DETOUR if f[IDLE] < IDLE_LONG else FAR if f[IDLE] % ASK_AGAIN >= IDLE_VERY_LONG else 10 * DETOUR


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
