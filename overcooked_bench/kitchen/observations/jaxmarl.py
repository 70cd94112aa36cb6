"""`jaxmarl`: what an agent of JaxMARL's kitchen sees, channels first.

It is `lossless26` with one difference: a counter with something on it is not shown as a counter. JaxMARL itself puts
the channels last.

Source: JaxMARL 0.2.0 (Rutherford et al. 2024), `Overcooked.get_obs`.
"""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import CELLS, Batch
from overcooked_bench.kitchen.codes import COUNTER, ONION_DISPENSER
from overcooked_bench.kitchen.image import CHANNELS, NUM_CHANNELS
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.grid import Grid
from overcooked_bench.kitchen.observations.observation import Live, PastState

COUNTERS: Final = CHANNELS.index("counters")


@jit
def hide_laden_counters(rows: NDArray[np.uint16], out: NDArray[np.uint8]) -> None:
    """Erases counters with something on them from the views of N kitchens.

    Args:
        rows: (N, ...) uint16, see `Batch`.
        out: (N, V, 26 * C) uint8, changed in its plane of counters.
    """
    num_cells = out.shape[2] // NUM_CHANNELS
    for i in range(rows.shape[0]):
        for cell in range(num_cells):
            if COUNTER < rows[i, CELLS + cell] < ONION_DISPENSER:
                for v in range(out.shape[1]):
                    out[i, v, COUNTERS * num_cells + cell] = 0


class JaxMarl(Grid):
    """The views of JaxMARL's `Overcooked`, which has onions alone."""

    def refuses(self, layout: Layout) -> str:
        """Refuses layouts with tomatoes, which JaxMARL's kitchen does not have."""
        return f"{self.name!r} has no tomatoes, and this layout has; use 'lossless26'" if layout.has_tomatoes else ""

    def write(
        self,
        prepared: Any,
        batch: Batch,
        past: Sequence[PastState],
        viewers: NDArray[np.int64],
        out: NDArray[Any],
    ) -> None:
        """Writes the 26 planes; see `Observation.write`."""
        super().write(prepared, batch, past, viewers, out)
        hide_laden_counters(batch.rows, out)

    def live(self, layout: Layout) -> Live:
        """Adds the counters that a chef can face to what can change; see `Observation.live`."""
        area = layout.width * layout.height
        known = super().live(layout)
        objects = known.places[known.places // area == CHANNELS.index("onions")] % area
        counters = COUNTERS * area + objects[[layout.rows[k // layout.width][k % layout.width] == "X" for k in objects]]
        places = np.union1d(known.places, counters)
        shown = known.shown.copy()
        shown[shown >= 0] = np.searchsorted(places, known.places)[shown[shown >= 0]]
        shown[counters] = np.searchsorted(places, counters)
        return Live(places, shown)


OBSERVATION: Final = JaxMarl("jaxmarl", [tuple(range(NUM_CHANNELS))])
