"""`Track`: what happened in one game, step by step, as arrays.

Axes: T steps.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray


class Track(NamedTuple):
    """What happened in one game of T steps; cells are numbered in row-major order.

    Attributes:
        cells: (T + 1, 2) the cell of each chef before each step, and after the last one.
        facing: (T + 1, 2) the direction of each chef then.
        actions: (T, 2) actions.
        taken: (T, 2) uint16, `StepResult.actions_taken`.
        points: (2,) points of the soups that each chef delivered.
    """

    cells: NDArray[Any]
    facing: NDArray[Any]
    actions: NDArray[Any]
    taken: NDArray[np.uint16]
    points: NDArray[np.float64]
