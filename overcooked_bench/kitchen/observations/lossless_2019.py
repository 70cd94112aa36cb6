"""`lossless_2019`: the 20 channels of the kitchen of 2019, with its fault, for agents that were trained to see it.

There, the objects in hands replaced all others of their kind where the state listed its objects. So while a chef holds
an onion (a dish, a soup), only what is held of that kind is shown: onions (dishes) on counters, and soups on counters
and in pots, which includes pots that are being filled, are missing. Both chefs' views leave out the same.

Source: overcooked_ai of 2019 (`OvercookedState.all_objects_by_type`, `OvercookedGridworld.lossless_state_encoding`).
"""

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import CELLS, HELD, POSITION, Batch
from overcooked_bench.kitchen.codes import (
    COUNTER,
    DISH,
    ONION,
    ONION_DISPENSER,
    POT_COOKING,
    POT_IDLE,
    POT_READY,
    RECIPES,
    SOUP,
)
from overcooked_bench.kitchen.image import CHANNELS, CHEF_CHANNELS
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.grid import Grid, plane_runs, write_views
from overcooked_bench.kitchen.observations.observation import PastState
from overcooked_bench.kitchen.tables import Tables

_TILES: Final = ("pots", "counters", "onion_dispensers", "dish_dispensers", "serving_tiles")
_OBJECTS: Final = ("onions_in_pot", "cook_time_remaining", "onions_in_soup", "dishes", "onions")
"""Channels of the image that change where the planes `IN_POT` to `ONIONS` do; what they show differs."""

IN_POT, COOKED, SOUPS, DISHES, ONIONS = range(5)
"""Planes after the tiles: onions in a pot, cooking or not; steps it has cooked; soups elsewhere; dishes; onions."""


class Pots(NamedTuple):
    """What the planes of the pots are computed from.

    Attributes:
        cells: (P,) uint16, the pots' cells.
        onions: (R,) uint8, onions in a pot by its recipe index.
        times: (R,) uint8, steps that it cooks by its recipe index.
    """

    cells: NDArray[np.uint16]
    onions: NDArray[np.uint8]
    times: NDArray[np.uint8]


class Lossless2019(Grid):
    """The chefs and tiles as `lossless` shows them, then the five planes of objects; urgency is missing."""

    def __init__(self) -> None:
        planes = tuple(CHANNELS.index(name) for name in (*CHANNELS[:CHEF_CHANNELS], *_TILES, *_OBJECTS))
        super().__init__("lossless_2019", [planes])
        self.runs = plane_runs(planes[: -len(_OBJECTS)])

    def prepare(self, layout: Layout, tables: Tables) -> Pots:
        """Looks up the layout's pots and cook times."""
        onions = np.array([onions for onions, _ in RECIPES], np.uint8)
        return Pots(tables.pots, onions, np.array(layout.cook_times, np.uint8))

    def write(
        self,
        prepared: Any,
        batch: Batch,
        past: Sequence[PastState],
        viewers: NDArray[np.int64],
        out: NDArray[Any],
    ) -> None:
        """Writes (20, H, W) numbers per view; see `Observation.write`."""
        write_views(batch.rows, batch.image, self.runs, viewers, out, 0)
        objects = out.shape[2] // len(self.channels) * (len(self.channels) - len(_OBJECTS))
        write_objects(batch.rows, prepared.cells, prepared.onions, prepared.times, out[:, :, objects:])


@jit
def kind_of(item: int) -> int:
    """Returns the plane that shows an item, -1 for none."""
    if item == ONION:
        return ONIONS
    if item == DISH:
        return DISHES
    return SOUPS if item > SOUP else -1


@jit
def write_pot(
    view: NDArray[np.uint8],
    num_cells: int,
    cell: int,
    code: int,
    left: int,
    onions: NDArray[np.uint8],
    times: NDArray[np.uint8],
) -> None:
    """Writes the planes `IN_POT` and `COOKED` of a pot that is ready in `left` steps; see `write_objects`."""
    recipe = code - POT_IDLE
    if code > POT_COOKING:
        recipe = code - (POT_READY if code > POT_READY else POT_COOKING)
        view[COOKED * num_cells + cell] = times[recipe] - left
    view[IN_POT * num_cells + cell] = onions[recipe]


@jit
def write_objects(
    rows: NDArray[np.uint16],
    pots: NDArray[np.uint16],
    onions: NDArray[np.uint8],
    times: NDArray[np.uint8],
    out: NDArray[np.uint8],
) -> None:
    """Writes the planes of objects.

    Args:
        rows: (N, ...) uint16, see `Batch`; C cells.
        pots: See `Pots`.
        onions: See `Pots`.
        times: See `Pots`.
        out: (N, V, 5 * C) uint8, written.
    """
    num_cells = out.shape[2] // 5
    for i in range(rows.shape[0]):
        row = rows[i]
        held = kind_of(row[HELD]), kind_of(row[HELD + 1])
        for v in range(out.shape[1]):
            view = out[i, v]
            for k in range(view.shape[0]):
                view[k] = 0
            for cell in range(num_cells):
                code = row[CELLS + cell]
                kind = kind_of(code - COUNTER) if COUNTER <= code < ONION_DISPENSER else -1
                if kind >= 0 and kind not in held:
                    view[kind * num_cells + cell] = 1
            if SOUPS not in held:
                for p in range(pots.shape[0]):
                    cell, left = pots[p], row[CELLS + num_cells + p]
                    write_pot(view, num_cells, cell, row[CELLS + cell], left, onions, times)
            for chef in range(2):
                if held[chef] >= 0:
                    view[held[chef] * num_cells + row[POSITION + chef]] = 1


OBSERVATION: Final = Lossless2019()
