"""Compiles a layout and a cooking mode to the tables that the kernels read."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen import codes
from overcooked_bench.kitchen.batch import FACING, HELD, POSITION
from overcooked_bench.kitchen.codes import (
    FLOOR,
    MAX_INGREDIENTS,
    NUM_CELL_CODES,
    NUM_ITEMS,
    POT_IDLE,
    RECIPES,
    SOUP,
)
from overcooked_bench.kitchen.events import best_reachable
from overcooked_bench.kitchen.image import background, paint_table
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.rules import (
    AHEAD,
    CELL_BITS,
    COOK_TIME,
    COOKING_MODES,
    ITEM_BITS,
    PAINT,
    STARTS_ITSELF,
    WANTED,
    interact,
)


class Tables(NamedTuple):
    """A layout and a cooking mode compiled to tables. C cells in row-major order, P pots, F floor cells, K orders.

    Attributes:
        ways: (C, 10) uint16  for a floor cell: the cell ahead by facing (4), the wanted cell by action (6)
        outcomes: (64, 16) uint32  by faced cell code and held item: new cell code, new held item and the action taken
        by_code: (64, 11) uint8  by cell code: channels 16 to 24, whether a pot starts by itself, its cook time
        payments: (2, 16) float64  points for serving a held item; best payment reachable from a pot's recipe index
        pots: (P,) uint16  cells
        fresh: (C,) uint16  cell codes of the empty kitchen
        floor: (F, 2) uint16  cell and region of each floor cell
        allowed: (R, R) bool  whether a random start may put chef 0 in one region and chef 1 in the other
        standard: (2,) uint16  standard start cells, zeros if the layout has none
        orders: (K, 3) uint16  recipe index, onions and tomatoes of the orders
        background: (26 * C,) uint8  lossless encoding of the empty kitchen without chefs
    """

    ways: NDArray[np.uint16]
    outcomes: NDArray[np.uint32]
    by_code: NDArray[np.uint8]
    payments: NDArray[np.float64]
    pots: NDArray[np.uint16]
    fresh: NDArray[np.uint16]
    floor: NDArray[np.uint16]
    allowed: NDArray[np.bool_]
    standard: NDArray[np.uint16]
    orders: NDArray[np.uint16]
    background: NDArray[np.uint8]

    def faced(self, rows: NDArray[np.uint16]) -> NDArray[np.uint16]:
        """Returns the cell that each chef faces, (N, 2), in N kitchens' rows as in `Batch`."""
        return self.ways[rows[:, POSITION:FACING], AHEAD + rows[:, FACING:HELD]]


def compile_tables(layout: Layout, cooking: str) -> Tables:
    """Turns a layout and a cooking mode into the tables that the kernels read."""
    if cooking not in COOKING_MODES:
        raise WrongUse(f"cooking={cooking!r}; choose one of {', '.join(map(repr, COOKING_MODES))}")
    short = [order for order in layout.orders if sum(order) != MAX_INGREDIENTS]
    if cooking == "auto" and short:
        raise WrongUse(
            f"cooking='auto' starts a pot at its third ingredient, and orders with fewer, such as {short[0]} "
            "(onions, tomatoes), can never be cooked; use cooking='manual' or orders of three"
        )
    width, cells = layout.width, layout.width * layout.height
    fresh = np.array([codes.TILES[tile] for row in layout.rows for tile in row], np.uint16)
    ways = np.zeros((cells, 10), np.uint16)
    for x, y in layout.positions(" "):
        cell = y * width + x
        ways[cell, WANTED:] = cell
        for direction, (dx, dy) in enumerate(codes.DIRECTIONS):
            ahead = (y + dy) * width + x + dx
            ways[cell, AHEAD + direction] = ahead
            if fresh[ahead] == FLOOR:
                ways[cell, WANTED + direction] = ahead
    outcomes = np.zeros((1 << CELL_BITS, 1 << ITEM_BITS), np.uint32)
    for cell in range(NUM_CELL_CODES):
        for held in range(NUM_ITEMS):
            new_cell, new_held, done = interact(cell, held, cooking)
            outcomes[cell, held] = new_cell | new_held << CELL_BITS | done << (CELL_BITS + ITEM_BITS)
    by_code = np.zeros((1 << CELL_BITS, COOK_TIME + 1), np.uint8)
    by_code[:, PAINT:STARTS_ITSELF] = paint_table()
    for index, recipe in enumerate(RECIPES[1:], start=1):
        by_code[POT_IDLE + index, COOK_TIME] = layout.cook_times[index]
        by_code[POT_IDLE + index, STARTS_ITSELF] = cooking == "auto" and sum(recipe) == MAX_INGREDIENTS
    payments = np.zeros((2, 1 << ITEM_BITS))
    payments[0, SOUP : SOUP + len(RECIPES)] = layout.soup_rewards
    payments[1, : len(RECIPES)] = best_reachable(np.array(layout.soup_rewards))
    return Tables(
        ways=ways,
        outcomes=outcomes,
        by_code=by_code,
        payments=payments,
        pots=np.flatnonzero(fresh >= POT_IDLE).astype(np.uint16),
        fresh=fresh,
        floor=np.array([(y * width + x, region) for (x, y), region in layout.regions.items()], np.uint16),
        allowed=layout.start_regions,
        standard=np.array([y * width + x for x, y in layout.start_cells] or [0, 0], np.uint16),
        orders=np.array([(RECIPES.index(order), *order) for order in layout.orders], np.uint16),
        background=background(layout),
    )
