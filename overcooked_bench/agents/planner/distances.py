"""The compiled search for the shortest ways over the floor."""

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.jit import jit


@jit
def walk(
    tiles: NDArray[np.int64],
    beside: NDArray[np.int64],
    blocked: int,
    edge: NDArray[np.int64],
    ways: NDArray[np.int64],
) -> None:
    """Writes the steps from each floor cell to each floor cell.

    Args:
        tiles: (C,) 0 for floor.
        beside: (4, C) the next floor cell in each direction, -1 for none.
        blocked: A cell that no way leads through, -1 for none.
        edge: (C,) room to work in.
        ways: (C, C) one number everywhere, more than any way is long; written where a way leads.
    """
    far = ways[0, 0]
    for start in range(len(tiles)):
        if tiles[start] != 0:
            continue
        ways[start, start] = 0
        edge[0] = start
        done, known = 0, 1
        while done < known:
            c = edge[done]
            done += 1
            for direction in range(4):
                n = beside[direction, c]
                if n >= 0 and n != blocked and ways[start, n] == far:
                    ways[start, n] = ways[start, c] + 1
                    edge[known] = n
                    known += 1
