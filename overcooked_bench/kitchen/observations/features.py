"""The 96 hand-made features: each chef's surroundings relative to the nearest objects by walking distance.

Source: overcooked_ai (`OvercookedGridworld.featurize_state`, two pot slots, counters no goals).
The order of the soup counts is the code's, not the one of its docstring (public issue #165).
"""

from collections.abc import Sequence
from typing import Any, ClassVar, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import CELLS, FACING, HELD, POSITION, Batch
from overcooked_bench.kitchen.codes import (
    DISH,
    FLOOR,
    NOTHING,
    ONION,
    POT_COOKING,
    POT_IDLE,
    POT_READY,
    RECIPES,
    SOUP,
    TOMATO,
)
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.observation import Observation, PastState
from overcooked_bench.kitchen.rules import AHEAD, FIRST_OF_THREE, WANTED
from overcooked_bench.kitchen.tables import Tables

NUM_FEATURES: Final = 96
_LEAST_BOUND: Final = 20
_POT_SLOTS = 2
_BLOCK = 26 + 10 * _POT_SLOTS
_SOURCES = "OTDS"
_RECIPES = np.array(RECIPES, np.int64)


# The surroundings of a chef on a cell that faces a direction: columns of the table that `measure` makes.
_PLACE = 0  # x and y
_WALLS = 2  # 1 where the neighbour is no floor, by direction
_NEAREST = 6  # dx and dy of the nearest onion, tomato, dish and serving tile; 0 where none is in reach
_POTS = 14  # index of the nearest and next pot, -1 for none in reach; then dx and dy of both
_COLUMNS = 20


def measure(layout: Layout, tables: Tables) -> NDArray[np.int16]:
    """Finds the nearest objects from every cell: (C, 4, 20) int16 by cell and facing.

    Distance is the number of actions of a chef alone until it faces the object, turning towards a wall included; ties
    go to the first in row-major order.
    """
    cells = len(tables.fresh)
    place = np.array([(x, y) for y in range(layout.height) for x in range(layout.width)])
    table = np.zeros((cells, 4, _COLUMNS), np.int16)
    table[..., _PLACE : _PLACE + 2] = place[:, None]
    table[..., _WALLS : _WALLS + 4] = (tables.fresh[tables.ways[:, AHEAD : AHEAD + 4]] != FLOOR)[:, None]
    for kind, letter in enumerate(_SOURCES):
        targets = np.array([y * layout.width + x for x, y in layout.positions(letter)], int)
        if len(targets):
            steps = np.array([_actions_to(tables, cell) for cell in targets])
            delta = place[targets[steps.argmin(0)]] - place[:, None]
            at = _NEAREST + 2 * kind
            table[..., at : at + 2] = np.where(steps.min(0)[..., None] < _FAR, delta, 0)
    steps = np.array([_actions_to(tables, cell) for cell in tables.pots])
    order = steps.argsort(0, kind="stable")
    table[..., _POTS : _POTS + _POT_SLOTS] = -1
    for slot in range(min(_POT_SLOTS, len(tables.pots))):
        at = _POTS + _POT_SLOTS + 2 * slot
        reached = np.take_along_axis(steps, order, 0)[slot] < _FAR
        table[..., _POTS + slot] = np.where(reached, order[slot], -1)
        table[..., at : at + 2] = place[tables.pots[order[slot]]] - place[:, None]
    return table


_FAR = 2**30


def _actions_to(tables: Tables, goal: int) -> NDArray[np.int64]:
    """Counts the actions until a chef faces `goal`, by cell and facing: (C, 4), _FAR if it never can."""
    ahead, wanted = tables.ways[:, AHEAD : AHEAD + 4], tables.ways[:, WANTED : WANTED + 4]
    is_floor = (tables.fresh == FLOOR)[:, None]
    steps = np.where(is_floor & (ahead == goal), 0, _FAR)
    while True:
        after = steps[wanted, np.arange(4)].min(1, keepdims=True) + 1
        better = np.where(is_floor, np.minimum(steps, np.minimum(after, _FAR)), _FAR)
        if (better == steps).all():
            return steps
        steps = better


@jit
def write_features(
    rows: NDArray[np.uint16],
    pots: NDArray[np.uint16],
    around: NDArray[np.int16],
    seats: NDArray[np.int64],
    out: NDArray[np.float32],
) -> None:
    """Writes chefs' features in N kitchens.

    Args:
        rows: (N, ...) uint16, see `Batch`.
        pots: (P,) uint16, see `Tables`.
        around: (C, 4, 20) int16, from `measure`.
        seats: (N, V) int64, whose features are wanted.
        out: (N, V, 96) float32, written.
    """
    for i in range(rows.shape[0]):
        for v in range(seats.shape[1]):
            viewer = seats[i, v] & 1  # whatever was given, nothing outside the row is read
            other = 1 - viewer
            for k in range(NUM_FEATURES):
                out[i, v, k] = 0
            own_place, other_place = around[rows[i, POSITION + viewer], 0], around[rows[i, POSITION + other], 0]
            for axis in range(2):
                out[i, v, 2 * _BLOCK + axis] = other_place[_PLACE + axis] - own_place[_PLACE + axis]
                out[i, v, 2 * _BLOCK + 2 + axis] = own_place[_PLACE + axis]
            for block in range(2):
                chef = other if block else viewer
                _write_block(rows[i], pots, around, chef, out[i, v], block * _BLOCK)


@jit
def _write_block(
    row: NDArray[np.uint16],
    pots: NDArray[np.uint16],
    around: NDArray[np.int16],
    chef: int,
    out: NDArray[np.float32],
    first: int,
) -> None:
    held, facing = row[HELD + chef], row[FACING + chef]
    near = around[row[POSITION + chef], facing]
    out[first + facing] = 1
    if held != NOTHING:
        out[first + 4 + (0 if held == ONION else 1 if held > SOUP else 2 if held == DISH else 3)] = 1
    for kind in range(4):
        at = first + (18 if kind == 3 else 8 + 2 * kind)
        item = ONION if kind == 0 else TOMATO if kind == 1 else DISH
        if kind == 3 or held != item:
            out[at] = near[_NEAREST + 2 * kind]
            out[at + 1] = near[_NEAREST + 2 * kind + 1]
    if held > SOUP:
        out[first + 16] = _RECIPES[held - SOUP, 0]
        out[first + 17] = _RECIPES[held - SOUP, 1]
    for slot in range(_POT_SLOTS):
        p, at = near[_POTS + slot], first + 22 + 10 * slot
        if p < 0:
            continue
        code = row[CELLS + pots[p]]
        recipe = code - (POT_READY if code > POT_READY else POT_COOKING if code > POT_COOKING else POT_IDLE)
        out[at] = 1
        out[at + 1] = code == POT_IDLE
        out[at + 2] = code >= POT_IDLE + FIRST_OF_THREE
        out[at + 3] = POT_COOKING < code <= POT_READY
        out[at + 4] = code > POT_READY
        out[at + 5] = _RECIPES[recipe, 0]
        out[at + 6] = _RECIPES[recipe, 1]
        out[at + 7] = row[CELLS + around.shape[0] + p]
        out[at + 8] = near[_POTS + _POT_SLOTS + 2 * slot]
        out[at + 9] = near[_POTS + _POT_SLOTS + 2 * slot + 1]
    for direction in range(4):
        out[first + 22 + 10 * _POT_SLOTS + direction] = near[_WALLS + direction]


class Features(Observation):
    """The features as an observation; between two objects at the same distance, they choose by column."""

    name = "features"
    dtype: ClassVar[np.dtype[Any]] = np.dtype(np.float32)

    def shape(self, layout: Layout) -> tuple[int, ...]:
        """Returns (96,)."""
        return (NUM_FEATURES,)

    def low(self, layout: Layout) -> float:
        """Returns the longest distance to the left or upwards."""
        return -max(layout.width, layout.height)

    def high(self, layout: Layout) -> float:
        """Returns the longest distance or cook time."""
        return max(layout.width, layout.height, _LEAST_BOUND, *layout.cook_times)

    def prepare(self, layout: Layout, tables: Tables) -> tuple[NDArray[np.uint16], NDArray[np.int16]]:
        """Returns the cells of the pots, and the nearest objects from every cell."""
        return tables.pots, measure(layout, tables)

    def write(
        self,
        prepared: Any,
        batch: Batch,
        past: Sequence[PastState],
        viewers: NDArray[np.int64],
        out: NDArray[Any],
    ) -> None:
        """Writes 96 numbers per view; see `Observation.write`."""
        pots, around = prepared
        write_features(batch.rows, pots, around, viewers, out)


OBSERVATION: Final = Features()
