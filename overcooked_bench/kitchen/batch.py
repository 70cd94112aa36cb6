"""N kitchens as arrays: `Batch`, their current state, and `Past`, their states in the last few steps."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

# Columns of a kitchen's row; the cells follow in row-major order, then the remaining steps of the pots.
POSITION: Final = 0  # + chef: cell that the chef stands on
FACING: Final = 2  # + chef: direction the chef looks
HELD: Final = 4  # + chef: item in the hands
CELLS: Final = 6  # + cell: code of the cell, tile and content together (codes.py)


class Batch:
    """N kitchens of one layout; C cells, P pots.

    Everything that a step changes is in one row of small numbers per kitchen, since passing a further array to a
    compiled kernel costs more than the work in it; the properties are views into the rows.

    Attributes:
        rows: (N, 6 + C + P) uint16  chefs, cells and pots
        clock: (N,) int64  steps since the start
        image: (N, 26 * C) uint8  lossless encoding, channel by channel, with the chefs' own channels 0 to 9 left empty;
            it follows from the rest, and is kept up to date cell by cell
        stream: (N, 2) uint64  key of the kitchen's random stream, numbers drawn from it so far
    """

    def __init__(self, num_kitchens: int, num_cells: int, num_pots: int) -> None:
        self._num_cells = num_cells
        self.rows: NDArray[np.uint16] = np.zeros((num_kitchens, CELLS + num_cells + num_pots), np.uint16)
        self.clock: NDArray[np.int64] = np.zeros(num_kitchens, np.int64)
        self.image: NDArray[np.uint8] = np.zeros((num_kitchens, 26 * num_cells), np.uint8)
        self.stream: NDArray[np.uint64] = np.zeros((num_kitchens, 2), np.uint64)

    def chosen(self, kitchens: NDArray[np.int64]) -> "Batch":
        """Returns copies of some kitchens."""
        some = Batch(0, self._num_cells, 0)
        some.rows, some.clock = self.rows[kitchens], self.clock[kitchens]
        some.image, some.stream = self.image[kitchens], self.stream[kitchens]
        return some

    @property
    def position(self) -> NDArray[np.uint16]:
        """Cell that each chef stands on, (N, 2)."""
        return self.rows[:, POSITION:FACING]

    @property
    def facing(self) -> NDArray[np.uint16]:
        """Direction each chef looks, (N, 2)."""
        return self.rows[:, FACING:HELD]

    @property
    def held(self) -> NDArray[np.uint16]:
        """Item in each chef's hands, (N, 2)."""
        return self.rows[:, HELD:CELLS]

    @property
    def cells(self) -> NDArray[np.uint16]:
        """Code of each cell, (N, C)."""
        return self.rows[:, CELLS : CELLS + self._num_cells]

    @property
    def remaining(self) -> NDArray[np.uint16]:
        """Steps until a cooking pot is ready, 0 for other pots, (N, P)."""
        return self.rows[:, CELLS + self._num_cells :]


class Past:
    """The rows and images of the last states, in a ring that all kitchens share, with room for the next one.

    Args:
        batch: The kitchens as they are now.
        history: How many past states to keep.
    """

    def __init__(self, batch: Batch, history: int) -> None:
        self.history = history
        self._ring = [(batch.rows.copy(), batch.image.copy()) for _ in range(history + 1)]
        self._next = 0

    def remember(self, batch: Batch) -> None:
        """Records the current state; `advance` makes it the newest past state."""
        rows, image = self._ring[self._next]
        rows[...], image[...] = batch.rows, batch.image

    def advance(self) -> None:
        """Makes the state that was recorded last the newest past state."""
        self._next = (self._next + 1) % len(self._ring)

    def restart(self, batch: Batch, mask: NDArray[np.bool_]) -> None:
        """Replaces all past states by the current one, in the kitchens of a mask, (N,) bool."""
        for rows, image in self._ring:
            rows[mask], image[mask] = batch.rows[mask], batch.image[mask]

    def newest_first(self) -> list[tuple[NDArray[np.uint16], NDArray[np.uint8]]]:
        """Lists the rows and images of the past states, one step ago first."""
        return [self._ring[self._next - age] for age in range(1, self.history + 1)]
