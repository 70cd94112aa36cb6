"""Facts that a scripted planner knows at one step, and what it sees of the two chefs.

Axes: B rows (simultaneous episodes), C cells. The facts of a row are one row of `facts`, (B, FACTS) int64, by the
indices below. Compiled code is kept short and flat: every line, and every call inside it, costs compile time.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.planner.tables import DISH, FAR, ONION, TOMATO
from overcooked_bench.kitchen.image import CHANNELS
from overcooked_bench.kitchen.jit import jit

Facts = NDArray[np.int64]
Table = NDArray[np.int64]

# Observed: cell, direction and hands of both chefs.
ME, FACING, HAND, PARTNER, PARTNER_FACING, PARTNER_HAND = range(6)
# Remembered: own last cell and the one before, and whether a step was tried; steps without progress; the last state of
# the partner and of the pots, and for how many steps they have not changed; how often patience ran out; steps left to
# keep out of the partner's way; steps left to go straight (above 0) or around (below 0); extra steps that a way through
# the partner counts.
LAST_CELL, CELL_BEFORE, TRIED, STUCK, PARTNER_WAS, IDLE = range(6, 12)
POTS_WERE, STALE, STRIKES, YIELDING, RESOLVED, THROUGH = range(12, 18)
# Needs of the pots: number of missing ingredients, which kinds (bits), soups in progress, steps until the first is
# ready.
POTS_NOW, NEED, BITS, SOUPS, SOONEST = range(18, 23)
# Counters between the two chefs' regions: number, free ones, those with food, those with a dish.
SHARED, ROOM, FOODS, DISHES = range(23, 27)
# Whether both are in one region, this chef reaches a pot, the partner does, this chef reaches a serving tile; whether
# to rely on the partner at all, on its dish, on its food.
SAME, COOKS, PARTNER_COOKS, SERVES, ACTIVE, PARTNER_DISH, PARTNER_FOOD = range(27, 34)
# Dishes and ingredients that no chef is fetching yet; whether a pot has room for one, and whether to start a pot.
DISHES_WANTED, FOOD_WANTED, FOOD_ROOM, STARTS = range(34, 38)
# The errand, the tile to work at or -1, steps to the tile in `USE`; the action, the floor cell it leads to or -1.
ERRAND, GOAL, USE_STEPS, ACTION, AHEAD = range(38, 43)
# Errands: fetch item 1 to 4; wait; use the held object; start a pot; hand over; put down; clear a shared counter. For
# each, the steps of the best way, of the partner's best way, and the tile.
WAIT, USE, START, HAND_OVER, PUT_DOWN, CLEAR, ERRANDS = 0, 5, 6, 7, 8, 9, 10
# Free counters over which its habits let it hand food; the counter to pass the held object over, or -1.
FOOD_PLACES, PASS_AT = range(43, 45)
BEST: Final = 45
PARTNER_BEST: Final = BEST + ERRANDS
AT: Final = PARTNER_BEST + ERRANDS
# Whether it keeps to its habits, as pots make progress; its job at this step.
INSISTS: Final = AT + ERRANDS
ROLE: Final = INSISTS + 1
FACTS: Final = ROLE + 1

PATIENCE: Final = 30  # steps without a change in a pot after which the partner is not relied on; less with each strike
LEAST_PATIENCE: Final = 8
IDLE_LONG, IDLE_VERY_LONG, ASK_AGAIN = 8, 24, 120  # idle steps: no help; a wall; until another attempt
DETOUR: Final = 4  # longest detour, in steps, that is preferred to waiting for the partner to leave

_OWN, _OTHER = CHANNELS.index("own_position"), CHANNELS.index("other_position")
_OWN_NORTH, _OTHER_NORTH = CHANNELS.index("own_faces_north"), CHANNELS.index("other_faces_north")
_ITEMS = tuple(CHANNELS.index(name) for name in ("onions", "tomatoes", "dishes", "soup_done"))


@jit
def item_at(view: NDArray[np.uint8], c: int) -> np.int64:
    """Returns the item on a counter or in a chef's hands at a cell; view: (26, C)."""
    item: np.int64 = view[_ITEMS[0], c] + 2 * view[_ITEMS[1], c] + 3 * view[_ITEMS[2], c] + 4 * view[_ITEMS[3], c]
    return item


@jit
def look(views: NDArray[np.uint8], facts: Facts) -> None:
    """Finds both chefs and their hands in (B, 26, C) observations, and compares them with the last step."""
    for row in range(views.shape[0]):
        view, f = views[row], facts[row]
        for c in range(views.shape[2]):
            if view[_OWN, c] or view[_OTHER, c]:
                first, faces = (ME, _OWN_NORTH) if view[_OWN, c] else (PARTNER, _OTHER_NORTH)
                f[first] = c
                f[first + 1] = view[faces + 1, c] + 2 * view[faces + 2, c] + 3 * view[faces + 3, c]
                f[first + 2] = item_at(view, c)
        back = f[ME] == f[LAST_CELL] or f[ME] == f[CELL_BEFORE]
        f[STUCK] = f[STUCK] + 1 if f[TRIED] and back else max(0, f[STUCK] - 1)
        partner = (f[PARTNER] * 4 + f[PARTNER_FACING]) * 8 + f[PARTNER_HAND]
        f[IDLE] = f[IDLE] + 1 if f[PARTNER_WAS] == partner else 0
        f[CELL_BEFORE], f[LAST_CELL], f[PARTNER_WAS], f[TRIED] = f[LAST_CELL], f[ME], partner, 0
        f[YIELDING] = max(0, f[YIELDING] - 1)
        f[RESOLVED] -= int(f[RESOLVED] > 0) - int(f[RESOLVED] < 0)
        f[INSISTS] = f[STALE] < max(LEAST_PATIENCE, PATIENCE >> f[STRIKES])
        f[THROUGH] = DETOUR if f[IDLE] < IDLE_LONG else FAR if f[IDLE] % ASK_AGAIN >= IDLE_VERY_LONG else 10 * DETOUR


@jit
def trust(facts: Facts) -> None:
    """Judges whether to rely on the partner, by whether it moves and whether the pots make progress."""
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
        f[PARTNER_DISH] = waits and f[PARTNER_COOKS] and f[PARTNER_HAND] == DISH
        f[PARTNER_FOOD] = f[ACTIVE] and f[PARTNER_COOKS] and (f[PARTNER_HAND] == ONION or f[PARTNER_HAND] == TOMATO)
