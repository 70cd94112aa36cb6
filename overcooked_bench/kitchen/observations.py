"""Grid observations: the 26-channel lossless encoding, its 22 onion channels, and stacks of past ones.

Source: overcooked_ai (`OvercookedGridworld.lossless_state_encoding`), told in kitchen-spec section 4; the 22 channels are
those of the thesis, 4.3.2. Channel order is the reference's; arrays here are channels-first, [channel, y, x].
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen import codes
from overcooked_bench.kitchen.codes import COUNTER, NOTHING, POT_COOKING, POT_READY, RECIPES, SOUP, TILES
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.layout import Layout

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
FIRST_TILE: Final = CHANNELS.index("pots")
FIRST_OBJECT: Final = CHANNELS.index("onions_in_pot")
REMAINING: Final = CHANNELS.index("cook_time_remaining")
URGENCY: Final = CHANNELS.index("urgency")
NUM_OBJECT_CHANNELS: Final = URGENCY - FIRST_OBJECT
URGENT_STEPS: Final = 40
"""The last plane is 1 while fewer steps than this are left."""

ONION_CHANNELS: Final = tuple(k for k, name in enumerate(CHANNELS) if "tomato" not in name)
"""The 22 channels that are left without tomatoes."""


def background(layout: Layout) -> NDArray[np.uint8]:
    """Draws the empty kitchen: (26, C) uint8, with the tile channels set and all others 0."""
    image = np.zeros((NUM_CHANNELS, layout.width * layout.height), np.uint8)
    for channel, tile in enumerate("PXOTDS", start=FIRST_TILE):
        for x, y in layout.positions(tile):
            image[channel, y * layout.width + x] = 1
    return image


def paint_table() -> NDArray[np.uint8]:
    """Gives channels 16 to 24 of a cell by its code, (64, 9) uint8; a cooking pot's remaining time is filled in later."""
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
def paint_cell(image: NDArray[np.uint8], cell: int, code: int, remaining: int, paint: NDArray[np.uint8]) -> None:
    """Draws what lies in one cell into a kitchen's image, (26, C) uint8."""
    for k in range(NUM_OBJECT_CHANNELS):
        image[FIRST_OBJECT + k, cell] = paint[code, k]
    image[REMAINING, cell] = remaining


@jit
def paint_kitchen(
    image: NDArray[np.uint8],
    cells: NDArray[np.uint8],
    remaining: NDArray[np.uint8],
    position: NDArray[np.int16],
    held: NDArray[np.uint8],
    steps_left: int,
    background: NDArray[np.uint8],
    pot_at: NDArray[np.int16],
    paint: NDArray[np.uint8],
) -> None:
    """Draws a whole kitchen's image, (26, C) uint8, anew."""
    for channel in range(NUM_CHANNELS):
        for cell in range(cells.shape[0]):
            image[channel, cell] = background[channel, cell]
    for cell in range(cells.shape[0]):
        pot = pot_at[cell]
        paint_cell(image, cell, cells[cell], remaining[pot] if pot >= 0 else 0, paint)
    for chef in range(2):
        if held[chef] != NOTHING:
            paint_cell(image, position[chef], COUNTER + held[chef], 0, paint)
    if steps_left < URGENT_STEPS:
        paint_urgency(image)


@jit
def paint_urgency(image: NDArray[np.uint8]) -> None:
    """Fills the urgency plane of a kitchen's image, (26, C) uint8."""
    for cell in range(image.shape[1]):
        image[URGENCY, cell] = 1


@jit
def write_views(
    image: NDArray[np.uint8],
    position: NDArray[np.int16],
    facing: NDArray[np.uint8],
    runs: NDArray[np.int64],
    out: NDArray[np.uint8],
    first: int,
) -> None:
    """Copies whole planes of N kitchens to both chefs' views and marks the chefs.

    Args:
        image: (N, 26, C) uint8.
        position: (N, 2) int16.
        facing: (N, 2) uint8.
        runs: (R, 3) int64, runs of planes to copy: first plane of the image, first plane of the view, how many.
        out: (N, 2, planes, C) uint8, written; view k is chef k's.
        first: Plane of the views to begin at.
    """
    cells = image.shape[2]
    flat, views = image.reshape(image.shape[0], -1), out.reshape(out.shape[0], 2, -1)
    for i in range(image.shape[0]):
        for run in range(runs.shape[0]):
            start, to, size = runs[run, 0] * cells, (first + runs[run, 1]) * cells, runs[run, 2] * cells
            for k in range(size):
                views[i, 0, to + k] = flat[i, start + k]
            for k in range(size):
                views[i, 1, to + k] = flat[i, start + k]
        mark_chefs(position[i], facing[i], out[i], first)


@jit
def mark_chefs(position: NDArray[np.int16], facing: NDArray[np.uint8], views: NDArray[np.uint8], first: int) -> None:
    """Sets the ten chef channels of one kitchen, from plane `first` on, in both views (2, planes, C); zeros elsewhere."""
    for viewer in range(2):
        own, other = position[viewer], position[1 - viewer]
        views[viewer, first, own] = 1
        views[viewer, first + 1, other] = 1
        views[viewer, first + 2 + facing[viewer], own] = 1
        views[viewer, first + 6 + facing[1 - viewer], other] = 1


def plane_runs(channels: tuple[int, ...]) -> NDArray[np.int64]:
    """Groups channels into runs of neighbours: (R, 3) int64, as `write_views` takes them."""
    runs: list[list[int]] = []
    for to, channel in enumerate(channels):
        if runs and channel == runs[-1][0] + runs[-1][2]:
            runs[-1][2] += 1
        else:
            runs.append([channel, to, 1])
    return np.array(runs, np.int64)


@jit
def write_chefs(position: NDArray[np.int16], facing: NDArray[np.uint8], out: NDArray[np.uint8], first: int) -> None:
    """Marks the chefs of N kitchens in ten empty planes of both views, from plane `first` on; out (N, 2, planes, C)."""
    for i in range(out.shape[0]):
        mark_chefs(position[i], facing[i], out[i], first)
