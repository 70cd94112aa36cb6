"""Moves a scripted chef along shortest paths, around the partner or out of its way, without deadlocks."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.planner.facts import (
    ACTION,
    AHEAD,
    AT,
    FACING,
    GOAL,
    HAND,
    IDLE,
    ME,
    PARTNER,
    PARTNER_FACING,
    PARTNER_HAND,
    RESOLVED,
    STUCK,
    THROUGH,
    TRIED,
    WAIT,
    YIELDING,
    Facts,
    Table,
)
from overcooked_bench.agents.planner.tables import BESIDE, COST, FAR, NEXT, LayoutTables
from overcooked_bench.kitchen.codes import INTERACT, STAY
from overcooked_bench.kitchen.jit import jit

_PUSHED_LONG: Final = 3  # steps stuck after which even the chef with priority may step aside
_YIELD: Final = 3  # steps to keep out of the way
_RESOLVE: Final = 8  # steps to keep to one way, once two ways have been tried in turn


def walk(plan: LayoutTables, coins: NDArray[np.float64], facts: Facts) -> NDArray[np.int64]:
    """Returns the actions that lead to GOAL and interact there, or lead to the cell to wait on.

    Args:
        plan: The layout's tables.
        coins: (B,) random numbers in [0, 1), one per row for this step.
        facts: (B, FACTS), with GOAL; records what was tried.

    Returns:
        (B,) int64.
    """
    _head_for_goal(plan.grid, plan.ways, plan.around, coins, facts)
    _give_way(plan.grid, plan.ways, coins, facts)
    return facts[:, ACTION].copy()


@jit
def _head_for_goal(grid: Table, ways: Table, around: Table, coins: NDArray[np.float64], facts: Facts) -> None:
    """Sets ACTION to the first step of a shortest way, around the partner or straight through its cell."""
    for row in range(facts.shape[0]):
        f = facts[row]
        me, partner = f[ME], f[PARTNER]
        goal = f[GOAL] if f[GOAL] >= 0 else f[AT + WAIT]
        way = around[partner if around.shape[0] > 1 else 0]
        if f[STUCK] > 1 and f[RESOLVED] == 0:
            f[RESOLVED] = _RESOLVE if coins[row] < 0.5 else -_RESOLVE
        straight = way[me, goal] > ways[me, goal] + f[THROUGH]
        if f[RESOLVED] != 0:
            straight = f[RESOLVED] > 0 or way[me, goal] >= FAR
        if straight:
            way = ways
        f[ACTION], f[AHEAD] = STAY, -1
        for direction in range(4):
            n = grid[NEXT + direction, me]
            if grid[BESIDE + direction, me] == goal and f[GOAL] >= 0:
                f[ACTION] = INTERACT if f[FACING] == direction else direction
            elif n >= 0 and way[n, goal] + grid[COST + direction, me] == way[me, goal] and (straight or n != partner):
                f[ACTION], f[AHEAD] = direction, n


@jit
def _give_way(grid: Table, ways: Table, coins: NDArray[np.float64], facts: Facts) -> None:
    """Waits for the partner or steps aside, preferably away from it; their hands decide, or a coin in a tie."""
    for row in range(facts.shape[0]):
        f, coin = facts[row], coins[row]
        me, partner, ahead, waits = f[ME], f[PARTNER], f[AHEAD], f[GOAL] < 0
        evades = waits and ahead < 0 and f[IDLE] > 0 and grid[NEXT + f[PARTNER_FACING], partner] == me
        if ahead == partner:
            mine, theirs = 0 if waits else 1 + f[HAND], 1 + f[PARTNER_HAND]
            evades = mine < theirs or (coin < 0.5 and (mine == theirs or f[STUCK] >= _PUSHED_LONG))
        elif ahead >= 0 and ((f[STUCK] > 0 and coin < 0.5) or (f[YIELDING] > 0 and ways[partner, ahead] <= 1)):
            f[ACTION], f[AHEAD] = STAY, -1
        if evades:
            f[ACTION], f[AHEAD], f[YIELDING], best = STAY, -1, _YIELD, -1
            for k in range(4):
                direction = (k + int(coin * 8)) % 4
                n = grid[NEXT + direction, me]
                if n >= 0 and n != partner and ways[partner, n] > best:
                    best, f[ACTION], f[AHEAD] = ways[partner, n], direction, n
        f[TRIED] = f[AHEAD] >= 0
