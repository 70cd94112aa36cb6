"""`stack_states`: `lossless` now and one, two and three steps ago."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import Batch
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.grid import HISTORY, ONION_CHANNELS, Grid, write_views
from overcooked_bench.kitchen.observations.observation import PastState

_PLANES: Final = len(ONION_CHANNELS)


class StackStates(Grid):
    """The current state, then whole past states, along an axis of their own."""

    def shape(self, layout: Layout) -> tuple[int, ...]:
        """Returns (states, planes, H, W)."""
        return 1 + HISTORY, _PLANES, layout.height, layout.width

    def write(
        self,
        prepared: Any,
        batch: Batch,
        past: Sequence[PastState],
        viewers: NDArray[np.int64],
        out: NDArray[Any],
    ) -> None:
        """Writes (4, 22, H, W) numbers per view; see `Observation.write`."""
        runs, first = self.runs, 0
        write_views(batch.rows, batch.image, runs, viewers, out, first)
        for age in range(HISTORY):
            first += _PLANES
            rows, image = past[age]
            write_views(rows, image, runs, viewers, out, first)


OBSERVATION: Final = StackStates("stack_states", [ONION_CHANNELS] * (1 + HISTORY))
