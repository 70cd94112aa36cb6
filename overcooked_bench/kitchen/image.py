"""A kitchen's image: the 26-channel lossless encoding that each step updates, cell by cell.

Channel order is the reference's; arrays here are channels-first, [channel, y, x]. `observations/` makes the chefs'
observations from it.

Source: overcooked_ai (`OvercookedGridworld.lossless_state_encoding`).
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen import codes
from overcooked_bench.kitchen.batch import CELLS, HELD, POSITION
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
"""The first channels, which show the two chefs; empty in the image, since they depend on the observing chef."""

FIRST_TILE: Final = CHANNELS.index("pots")
FIRST_OBJECT: Final = CHANNELS.index("onions_in_pot")
FIRST_CARRIED: Final = CHANNELS.index("onions_in_soup")
REMAINING: Final = CHANNELS.index("cook_time_remaining")
URGENCY: Final = CHANNELS.index("urgency")
NUM_OBJECT_CHANNELS: Final = URGENCY - FIRST_OBJECT
URGENT_STEPS: Final = 40
"""The last plane is 1 while fewer steps than this are left."""


def background(layout: Layout) -> NDArray[np.uint8]:
    """Draws the empty kitchen: (26 * C,) uint8, with the tile channels set and all others 0."""
    image = np.zeros((NUM_CHANNELS, layout.width * layout.height), np.uint8)
    for channel, tile in enumerate("PXOTDS", start=FIRST_TILE):
        for x, y in layout.positions(tile):
            image[channel, y * layout.width + x] = 1
    return image.reshape(-1)


def paint_table() -> NDArray[np.uint8]:
    """Returns channels 16 to 24 of a cell by its code, (64, 9) uint8, without a cooking pot's remaining time."""
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
    """Draws the content of one cell into a kitchen's image, (26 * C,) uint8; `by_code` as in `Tables`."""
    at, plane = np.uint64(FIRST_OBJECT * num_cells + cell), np.uint64(num_cells)  # unsigned: no index counts backwards
    for k in range(NUM_OBJECT_CHANNELS):
        picture[at] = by_code[code, k]
        at += plane
    picture[np.uint64(REMAINING * num_cells + cell)] = remaining


@jit
def paint_hand(picture: NDArray[np.uint8], num_cells: int, cell: int, item: int, by_code: NDArray[np.uint8]) -> None:
    """Draws the item that a chef on a floor cell holds, or NOTHING; like `paint_cell` without the channels of pots."""
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
    """Redraws a whole kitchen's image, (26 * C,) uint8; `row` as in `Batch`, tables as in `Tables`."""
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
