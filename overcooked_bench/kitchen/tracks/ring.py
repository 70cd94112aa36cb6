"""Which way chefs walk around the middle of a kitchen.

Axes: T steps.
"""

from math import ceil, floor
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.layout import Layout

STRETCH: Final = 100
"""Steps over which walking to and fro cancels out; making a soup takes about as long."""


def find_middle(layout: Layout) -> tuple[float, float] | None:
    """Returns the middle of the one block of counters that the floor surrounds, as (x, y).

    Args:
        layout: A layout.

    Returns:
        The mean of the block's cells, or its cell nearest to that if the mean is not on the block; None if the layout
        has no such block, or several.
    """
    left = {(x, y) for y in range(layout.height) for x in range(layout.width)} - set(layout.positions(" "))
    blocks = []
    while left:
        edge, block = [left.pop()], set()
        while edge:
            x, y = edge.pop()
            block.add((x, y))
            near = {(x + dx, y + dy) for dx in (-1, 0, 1) for dy in (-1, 0, 1)} & left
            left -= near
            edge += near
        if all(0 < x < layout.width - 1 and 0 < y < layout.height - 1 for x, y in block):
            blocks.append(block)
    if len(blocks) != 1:
        return None
    (block,) = blocks
    middle_x, middle_y = (float(mean) for mean in np.mean(sorted(block), axis=0))
    around = {(x, y) for x in (floor(middle_x), ceil(middle_x)) for y in (floor(middle_y), ceil(middle_y))}
    if around <= block:
        return middle_x, middle_y
    return min(sorted(block), key=lambda cell: (cell[0] - middle_x) ** 2 + (cell[1] - middle_y) ** 2)


def laps(x: NDArray[Any], y: NDArray[Any], middle: tuple[float, float]) -> NDArray[np.float64]:
    """Measures how far each chef walks around the middle, in laps, net of its way back within `STRETCH` steps.

    Args:
        x: (T + 1, 2) columns of both chefs.
        y: (T + 1, 2) rows.
        middle: See `find_middle`.

    Returns:
        (2, 2) laps of each chef: clockwise as seen from above, and anticlockwise.
    """
    angle = np.unwrap(np.arctan2(y - middle[1], x - middle[0]), axis=0) / (2 * np.pi)  # y points downwards
    marks = np.append(np.arange(0, len(angle) - 1, STRETCH), len(angle) - 1)
    net = np.diff(angle[marks], axis=0).round(9)  # nothing, not nearly nothing, of a way to and fro
    return np.stack([np.maximum(net, 0).sum(axis=0), np.maximum(-net, 0).sum(axis=0)], axis=1)
