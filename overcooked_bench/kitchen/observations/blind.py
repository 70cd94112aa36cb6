"""`blind`: `lossless` without the other chef: where it stands, where it looks, and what it holds.

What the other chef does to pots and counters can still be seen. An agent that sees this cannot adapt to its partner in
any other way, so that its score is what a fixed routine reaches.
"""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import FACING, POSITION, Batch
from overcooked_bench.kitchen.image import CHANNELS, FIRST_OBJECT, NUM_CHANNELS, URGENCY
from overcooked_bench.kitchen.observations.grid import ONION_CHANNELS, Grid
from overcooked_bench.kitchen.observations.observation import PastState

BLIND_CHANNELS: Final = tuple(k for k in ONION_CHANNELS if not CHANNELS[k].startswith("other_"))
"""The 17 channels that are left without tomatoes and without the other chef's position and facing."""

_OBJECTS: Final = slice(BLIND_CHANNELS.index(FIRST_OBJECT), BLIND_CHANNELS.index(URGENCY))


class Blind(Grid):
    """The planes of the kitchen and of the chef that looks."""

    def write(
        self,
        prepared: Any,
        batch: Batch,
        past: Sequence[PastState],
        viewers: NDArray[np.int64],
        out: NDArray[Any],
    ) -> None:
        """Writes (17, H, W) numbers per view; see `Observation.write`."""
        image = batch.image.reshape(len(batch.image), NUM_CHANNELS, -1)
        views = out.reshape(*viewers.shape, len(BLIND_CHANNELS), -1)
        views[...] = image[:, None, BLIND_CHANNELS]
        kitchen, view = np.indices(viewers.shape)
        own, facing, other = (
            batch.rows[kitchen, first + chef].astype(np.int64)
            for first, chef in ((POSITION, viewers), (FACING, viewers), (POSITION, 1 - viewers))
        )
        views[kitchen, view, _OBJECTS, other] = 0  # on floor there is nothing but what a chef holds
        views[kitchen, view, 0, own] = 1
        views[kitchen, view, 1 + facing, own] = 1


OBSERVATION: Final = Blind("blind", [BLIND_CHANNELS])
