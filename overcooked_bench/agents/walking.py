"""How a scripted chef gets there: along shortest paths, round the mate or out of its way, never locked for good."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.looking import (
    AT,
    FACING,
    GOAL,
    HAND,
    IDLE,
    MATE,
    MATE_FACING,
    MATE_HAND,
    ME,
    RESOLVED,
    STUCK,
    THROUGH,
    TRIED,
    WAIT,
    YIELDING,
    Facts,
    Table,
)
from overcooked_bench.agents.planning import FAR, NEXT
from overcooked_bench.kitchen.codes import INTERACT, STAY
from overcooked_bench.kitchen.jit import jit

_PUSHED_LONG: Final = 3  # steps stuck after which even the one that goes first may step aside
_YIELD: Final = 3  # steps one keeps out of the way
_RESOLVE: Final = 8  # steps one keeps to a way, once two ways have been tried in turn


@jit
def walk(
    grid: Table, ways: Table, around: Table, coins: NDArray[np.float64], width: int, facts: Facts, actions: Table
) -> None:
    """Writes the actions that lead to GOAL and work there, or to the cell to wait on.

    Args:
        grid: Tables as in `Plan`.
        ways: The same.
        around: The same.
        coins: (B,) numbers in [0, 1), the rows' own of this step.
        width: W.
        facts: (B, FACTS), with GOAL; what was tried is noted.
        actions: (B,), written.
    """
    for row in range(facts.shape[0]):
        f, coin = facts[row], coins[row]
        me, mate = f[ME], f[MATE]
        waits = f[GOAL] < 0
        goal = f[AT + WAIT] if waits else f[GOAL]
        passing = around[mate if around.shape[0] > 1 else 0]
        if f[STUCK] > 1 and f[RESOLVED] == 0:
            f[RESOLVED] = _RESOLVE if coin < 0.5 else -_RESOLVE
        round_it = passing[me, goal] <= ways[me, goal] + f[THROUGH]
        if f[RESOLVED] != 0:
            round_it = f[RESOLVED] < 0 and passing[me, goal] < FAR
        here = passing[me, goal] if round_it else ways[me, goal]
        action, ahead = STAY, -1
        for direction in range(4):
            n = grid[NEXT + direction, me]
            if (
                here == 0
                and not waits
                and me + (2 * direction - 1) * width * (direction < 2) + (5 - 2 * direction) * (direction > 1) == goal
            ):
                action = INTERACT if f[FACING] == direction else direction
            if (
                here > 0
                and n >= 0
                and (passing[n, goal] if round_it else ways[n, goal]) < here
                and not (round_it and n == mate)
            ):
                action, ahead = direction, n
        pushed = waits and here == 0 and f[IDLE] > 0 and grid[NEXT + f[MATE_FACING], mate] == me
        if ahead == mate:
            mine = 0 if waits else 1 + f[HAND]
            mates = 1 + f[MATE_HAND]
            pushed = mine < mates or (mine == mates and coin < 0.5) or (f[STUCK] >= _PUSHED_LONG and coin < 0.5)
        elif ahead >= 0 and ((f[STUCK] > 0 and coin < 0.5) or (f[YIELDING] > 0 and ways[mate, ahead] <= 1)):
            action, ahead = STAY, -1
        if pushed:
            action, ahead, best = STAY, -1, -1
            for k in range(4):
                direction = (k + int(coin * 8)) % 4
                n = grid[NEXT + direction, me]
                if n >= 0 and n != mate and ways[mate, n] > best:
                    best, action, ahead = ways[mate, n], direction, n
            f[YIELDING] = _YIELD
        f[TRIED] = ahead >= 0
        actions[row] = action
