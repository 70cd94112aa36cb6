"""The compiled search for the shortest ways over the floor."""

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.jit import jit


@jit
def walk(
    tiles: NDArray[np.int64],
    beside: NDArray[np.int64],
    costs: NDArray[np.int64],
    blocked: int,
    edge: NDArray[np.int64],
    ways: NDArray[np.int64],
) -> None:
    """Writes what the best way from each floor cell to each floor cell counts.

    Args:
        tiles: (C,) 0 for floor.
        beside: (4, C) the next floor cell in each direction, -1 for none.
        costs: (4, C) what the step to it counts, from 1.
        blocked: A cell that no way leads through, -1 for none.
        edge: (2, C) room to work in.
        ways: (C, C) one number everywhere, more than any way is long; written where a way leads.
    """
    for start in range(len(tiles)):
        if tiles[start] != 0:
            continue
        ways[start, start] = 0
        edge[0, 0], edge[1, :] = start, 0  # a ring of cells to go on from, and which cells are in it
        done, known = 0, 1
        while done < known:
            c = edge[0, done % len(tiles)]
            edge[1, c] = 0
            done += 1
            for direction in range(4):
                n, steps = beside[direction, c], ways[start, c] + costs[direction, c]
                if n >= 0 and n != blocked and steps < ways[start, n]:
                    ways[start, n] = steps
                    if edge[1, n] == 0:
                        edge[0, known % len(tiles)], edge[1, n] = n, 1
                        known += 1
