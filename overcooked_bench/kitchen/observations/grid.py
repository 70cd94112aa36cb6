"""`Grid`, an observation made of channels of the grid, and the kernels that copy them to the chefs' views.

Source: overcooked_ai (`OvercookedGridworld.lossless_state_encoding`).
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import FACING, POSITION, Batch
from overcooked_bench.kitchen.codes import DIRECTIONS
from overcooked_bench.kitchen.image import CHANNELS, CHEF_CHANNELS, NUM_CHANNELS, URGENCY
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.observation import Live, Observation, PastState

HISTORY: Final = 3
"""Past states in a stacked observation (thesis, 7.4: the last four states, the current one included)."""

ONION_CHANNELS: Final = tuple(k for k, name in enumerate(CHANNELS) if "tomato" not in name)
"""The 22 channels that are left without tomatoes (thesis, 4.3.2)."""

_LEAST_BOUND: Final = 20
_TOMATO_CHANNELS: Final = frozenset(range(NUM_CHANNELS)) - frozenset(ONION_CHANNELS)
_EXCHANGED: Final = {"east": "west", "west": "east"}


class Grid(Observation):
    """Channels of the grid for the current state, and optionally for past ones.

    Args:
        name: The observation's name.
        states: The channels of the image that each state shows, the current state first.

    Attributes:
        channels: The channel of each plane, those of past states included.
    """

    can_mirror: ClassVar[bool] = True

    def __init__(self, name: str, states: Sequence[tuple[int, ...]]) -> None:
        self.name, self.history = name, len(states) - 1
        self.channels = tuple(channel for state in states for channel in state)
        self.runs = plane_runs(states[0])
        self._mirror: list[int] = []
        for state in states:
            self._mirror += [len(self._mirror) + plane for plane in _exchanged_planes(state)]

    def refuses(self, layout: Layout) -> str:
        """Refuses layouts with tomatoes if the channels of tomatoes are missing."""
        if layout.has_tomatoes and not set(self.channels) >= _TOMATO_CHANNELS:
            return f"{self.name!r} has no tomato channels, and this layout has tomatoes; use 'lossless26'"
        return ""

    def shape(self, layout: Layout) -> tuple[int, ...]:
        """Returns (planes, H, W)."""
        return len(self.channels), layout.height, layout.width

    def high(self, layout: Layout) -> float:
        """Returns the longest cook time, at least 20 and never 255: SB3 takes a uint8 Box up to 255 for an image."""
        return max(_LEAST_BOUND, *layout.cook_times)

    def write(
        self,
        prepared: Any,
        batch: Batch,
        past: Sequence[PastState],
        viewers: NDArray[np.int64],
        out: NDArray[Any],
    ) -> None:
        """Writes the planes of the current state; see `Observation.write`."""
        write_views(batch.rows, batch.image, self.runs, viewers, out, 0)

    def mirrored(self, views: NDArray[Any]) -> NDArray[Any]:
        """Reverses every row of every plane, and exchanges the planes of east and west."""
        planes = views.reshape(-1, len(self.channels), *views.shape[-2:])
        return np.ascontiguousarray(planes[:, self._mirror, :, ::-1]).reshape(views.shape)

    def live(self, layout: Layout) -> Live:
        """Finds the numbers that can change during play; see `Observation.live`.

        Chefs stand on floor; contents are in pots; objects are on counters that a chef can face, or are carried over
        floor; urgency is the same in its whole plane. Tiles never change.
        """
        floor, pots = set(layout.positions(" ")), set(layout.positions("P"))
        reached = {(x + dx, y + dy) for x, y in floor for dx, dy in DIRECTIONS}
        things = floor | (set(layout.positions("X")) & reached)
        cells = {
            **dict.fromkeys(CHANNELS[:CHEF_CHANNELS], floor),
            **dict.fromkeys(("onions_in_pot", "tomatoes_in_pot", "cook_time_remaining"), pots),
            **dict.fromkeys(("onions_in_soup", "tomatoes_in_soup", "soup_done"), things | pots),
            **dict.fromkeys(("dishes", "onions", "tomatoes"), things),
            "urgency": {min(floor)},
        }
        area = layout.width * layout.height
        places = np.array(
            [
                plane * area + y * layout.width + x
                for plane, channel in enumerate(self.channels)
                for x, y in sorted(cells.get(CHANNELS[channel], ()), key=lambda cell: (cell[1], cell[0]))
            ]
        )
        shown = np.full((len(self.channels), area), -1)
        shown.reshape(-1)[places] = np.arange(len(places))
        urgent = [plane for plane, channel in enumerate(self.channels) if channel == URGENCY]
        shown[urgent] = shown[urgent].max(axis=1, keepdims=True)
        return Live(places, shown.reshape(-1))


def _exchanged_planes(channels: tuple[int, ...]) -> list[int]:
    """Returns the plane that the mirror image shows in the place of each one."""
    names = [CHANNELS[channel] for channel in channels]
    sides = [name.rpartition("_")[2] for name in names]
    return [
        names.index(name.removesuffix(side) + _EXCHANGED[side]) if side in _EXCHANGED else plane
        for plane, (name, side) in enumerate(zip(names, sides, strict=True))
    ]


@jit
def write_views(
    rows: NDArray[np.uint16],
    image: NDArray[np.uint8],
    runs: NDArray[np.int64],
    seats: NDArray[np.int64],
    out: NDArray[np.uint8],
    first: int,
) -> None:
    """Copies whole planes of N kitchens to the chefs' views and marks the chefs.

    Args:
        rows: (N, ...) uint16, see `Batch`.
        image: (N, 26 * C) uint8.
        runs: (R, 3) int64, runs of planes to copy: first plane of the image, first plane of the view, how many.
        seats: (N, V) int64, whose views are wanted.
        out: (N, V, planes * C) uint8, written.
        first: First plane of the views to write.
    """
    num_cells = image.shape[1] // NUM_CHANNELS
    for i in range(image.shape[0]):
        for v in range(seats.shape[1]):
            for run in range(runs.shape[0]):
                size = runs[run, 2] * num_cells
                source = image[i][runs[run, 0] * num_cells :]
                view = out[i, v][(first + runs[run, 1]) * num_cells :]
                for k in range(size):
                    view[k] = source[k]
            own = seats[i, v] & 1  # whatever was given, nothing outside the row is read
            row, other = rows[i], 1 - own
            own_cell, other_cell = row[POSITION + own], row[POSITION + other]
            view = out[i, v][first * num_cells :]
            view[own_cell] = 1
            view[num_cells + other_cell] = 1
            view[(2 + row[FACING + own]) * num_cells + own_cell] = 1
            view[(6 + row[FACING + other]) * num_cells + other_cell] = 1


def plane_runs(channels: tuple[int, ...]) -> NDArray[np.int64]:
    """Groups channels into runs of neighbours: (R, 3) int64, as `write_views` takes them."""
    runs: list[list[int]] = []
    for to, channel in enumerate(channels):
        if runs and channel == runs[-1][0] + runs[-1][2]:
            runs[-1][2] += 1
        else:
            runs.append([channel, to, 1])
    return np.array(runs, np.int64)
