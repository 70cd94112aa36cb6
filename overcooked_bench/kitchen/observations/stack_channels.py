"""`stack_channels`: `lossless`, then channels 0 to 9 of one, two and three steps ago."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import FACING, POSITION, Batch
from overcooked_bench.kitchen.image import CHEF_CHANNELS
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.grid import HISTORY, ONION_CHANNELS, Grid, write_views
from overcooked_bench.kitchen.observations.observation import PastState
from overcooked_bench.kitchen.tables import Tables

PAST_CHANNELS: Final = (0, 2, 3, 4, 5, 1, 6, 7, 8, 9)
"""Channels of each past state: own position and facing, then the other chef's."""


_FIRST: Final = len(ONION_CHANNELS)


class StackChannels(Grid):
    """The planes of the current state, then those of the chefs in past states."""

    def prepare(self, layout: Layout, tables: Tables) -> int:
        """Counts the cells."""
        return layout.width * layout.height

    def write(
        self,
        prepared: Any,
        batch: Batch,
        past: Sequence[PastState],
        viewers: NDArray[np.int64],
        out: NDArray[Any],
    ) -> None:
        """Writes (52, H, W) numbers per view; see `Observation.write`."""
        write_views(batch.rows, batch.image, self.runs, viewers, out, 0)
        first = _FIRST
        for age in range(HISTORY):
            write_chefs(past[age][0], prepared, viewers, out, first)
            first += CHEF_CHANNELS


@jit
def write_chefs(
    rows: NDArray[np.uint16], num_cells: int, seats: NDArray[np.int64], out: NDArray[np.uint8], first: int
) -> None:
    """Writes the ten planes `PAST_CHANNELS` of N kitchens from plane `first` on; otherwise as `grid.write_views`."""
    for i in range(rows.shape[0]):
        for v in range(seats.shape[1]):
            view = out[i, v][first * num_cells :]
            for k in range(CHEF_CHANNELS * num_cells):
                view[k] = 0
            for block in range(2):
                chef = (seats[i, v] + block) & 1
                cell, plane = rows[i, POSITION + chef], 5 * block
                view[plane * num_cells + cell] = 1
                view[(plane + 1 + rows[i, FACING + chef]) * num_cells + cell] = 1


OBSERVATION: Final = StackChannels("stack_channels", (ONION_CHANNELS, *[PAST_CHANNELS] * HISTORY))
