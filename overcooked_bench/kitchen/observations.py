"""Grid observations: the 26-channel lossless encoding, its 22 onion channels, and stacks of past ones.

The 22 channels are those of the thesis (4.3.2). Channel order is the reference's; arrays here are channels-first,
[channel, y, x].

Source: overcooked_ai (`OvercookedGridworld.lossless_state_encoding`).
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen import codes
from overcooked_bench.kitchen.codes import COUNTER, NOTHING, POT_COOKING, POT_READY, RECIPES, SOUP, TILES
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import CELLS, FACING, HELD, POSITION

CHANNELS: Final = (
    *("own_position", "other_position"),
    *("own_faces_north", "own_faces_south", "own_faces_east", "own_faces_west"),
    *("other_faces_north", "other_faces_south", "other_faces_east", "other_faces_west"),
    *("pots", "counters", "onion_dispensers", "tomato_dispensers", "dish_dispensers", "serving_tiles"),
    *("onions_in_pot", "tomatoes_in_pot", "onions_in_soup", "tomatoes_in_soup"),
    *("cook_time_remaining", "soup_done", "dishes", "onions", "tomatoes", "urgency"),
)
"""Names of the 26 channels."""

NUM_CHANNELS: Final = len(CHANNELS)
CHEF_CHANNELS: Final = 10
PAST_CHANNELS: Final = (0, 2, 3, 4, 5, 1, 6, 7, 8, 9)
"""What "stack_channels" shows of each past state: own position and facing, then the other's."""

FIRST_TILE: Final = CHANNELS.index("pots")
FIRST_OBJECT: Final = CHANNELS.index("onions_in_pot")
FIRST_CARRIED: Final = CHANNELS.index("onions_in_soup")
REMAINING: Final = CHANNELS.index("cook_time_remaining")
URGENCY: Final = CHANNELS.index("urgency")
NUM_OBJECT_CHANNELS: Final = URGENCY - FIRST_OBJECT
URGENT_STEPS: Final = 40
"""The last plane is 1 while fewer steps than this are left."""

ONION_CHANNELS: Final = tuple(k for k, name in enumerate(CHANNELS) if "tomato" not in name)
"""The 22 channels that are left without tomatoes."""


def background(layout: Layout) -> NDArray[np.uint8]:
    """Draws the empty kitchen: (26 * C,) uint8, with the tile channels set and all others 0."""
    image = np.zeros((NUM_CHANNELS, layout.width * layout.height), np.uint8)
    for channel, tile in enumerate("PXOTDS", start=FIRST_TILE):
        for x, y in layout.positions(tile):
            image[channel, y * layout.width + x] = 1
    return image.reshape(-1)


def paint_table() -> NDArray[np.uint8]:
    """Gives channels 16 to 24 of a cell by its code, (64, 9) uint8, without a cooking pot's remaining time."""
    table = np.zeros((64, NUM_OBJECT_CHANNELS), np.uint8)
    column = {name: k for k, name in enumerate(CHANNELS[FIRST_OBJECT:URGENCY])}
    table[COUNTER + codes.ONION, column["onions"]] = 1
    table[COUNTER + codes.TOMATO, column["tomatoes"]] = 1
    table[COUNTER + codes.DISH, column["dishes"]] = 1
    for index, recipe in enumerate(RECIPES):
        for code in (COUNTER + SOUP + index, POT_COOKING + index, POT_READY + index) if index else ():
            table[code, [column["onions_in_soup"], column["tomatoes_in_soup"]]] = recipe
            table[code, column["soup_done"]] = not POT_COOKING < code <= POT_READY
        table[TILES["P"] + index, [column["onions_in_pot"], column["tomatoes_in_pot"]]] = recipe
    return table


@jit
def paint_cell(
    picture: NDArray[np.uint8], num_cells: int, cell: int, code: int, remaining: int, by_code: NDArray[np.uint8]
) -> None:
    """Draws what lies in one cell into a kitchen's image, (26 * C,) uint8; `by_code` as in `Plan`."""
    at, plane = np.uint64(FIRST_OBJECT * num_cells + cell), np.uint64(num_cells)  # unsigned: no index counts backwards
    for k in range(NUM_OBJECT_CHANNELS):
        picture[at] = by_code[code, k]
        at += plane
    picture[np.uint64(REMAINING * num_cells + cell)] = remaining


@jit
def paint_hand(picture: NDArray[np.uint8], num_cells: int, cell: int, item: int, by_code: NDArray[np.uint8]) -> None:
    """Draws what a chef on a floor cell holds, NOTHING included; as `paint_cell` without the channels of pots."""
    at, plane = np.uint64(FIRST_CARRIED * num_cells + cell), np.uint64(num_cells)
    for k in range(FIRST_CARRIED - FIRST_OBJECT, NUM_OBJECT_CHANNELS):
        picture[at] = by_code[COUNTER + item, k]
        at += plane


@jit
def paint_urgency(picture: NDArray[np.uint8], num_cells: int) -> None:
    """Fills the urgency plane of a kitchen's image, (26 * C,) uint8."""
    for cell in range(num_cells):
        picture[URGENCY * num_cells + cell] = 1


@jit
def paint_kitchen(
    picture: NDArray[np.uint8],
    row: NDArray[np.uint16],
    steps_left: int,
    background: NDArray[np.uint8],
    by_code: NDArray[np.uint8],
    pots: NDArray[np.uint16],
) -> None:
    """Draws a whole kitchen's image, (26 * C,) uint8, anew; `row` as in `Batch`, tables as in `Plan`."""
    num_cells = background.shape[0] // NUM_CHANNELS
    for k in range(background.shape[0]):
        picture[k] = background[k]
    for cell in range(num_cells):
        paint_cell(picture, num_cells, cell, row[CELLS + cell], 0, by_code)
    for p in range(pots.shape[0]):
        picture[REMAINING * num_cells + pots[p]] = row[CELLS + num_cells + p]
    for chef in range(2):
        if row[HELD + chef] != NOTHING:
            paint_cell(picture, num_cells, row[POSITION + chef], COUNTER + row[HELD + chef], 0, by_code)
    if steps_left < URGENT_STEPS:
        paint_urgency(picture, num_cells)


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
        first: Plane of the views to begin at.
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


@jit
def write_chefs(
    rows: NDArray[np.uint16], num_cells: int, seats: NDArray[np.int64], out: NDArray[np.uint8], first: int
) -> None:
    """Writes the ten planes `PAST_CHANNELS` of N kitchens from plane `first` on; otherwise as `write_views`."""
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


def plane_runs(channels: tuple[int, ...]) -> NDArray[np.int64]:
    """Groups channels into runs of neighbours: (R, 3) int64, as `write_views` takes them."""
    runs: list[list[int]] = []
    for to, channel in enumerate(channels):
        if runs and channel == runs[-1][0] + runs[-1][2]:
            runs[-1][2] += 1
        else:
            runs.append([channel, to, 1])
    return np.array(runs, np.int64)
