"""The 96 hand-made features: each chef's surroundings relative to the nearest things by walking distance.

Source: overcooked_ai (`OvercookedGridworld.featurize_state`, two pot slots, counters no goals), told in kitchen-spec
section 5. The order of the soup counts is the code's, not the one of its docstring (public issue #165).
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import DISH, FLOOR, NOTHING, ONION, POT_COOKING, POT_IDLE, POT_READY, RECIPES, SOUP, TOMATO
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.rules import FIRST_OF_THREE, Plan
from overcooked_bench.kitchen.state import Batch

NUM_FEATURES: Final = 96
_POT_SLOTS = 2
_BLOCK = 26 + 10 * _POT_SLOTS
_SOURCES = "OTDS"
_RECIPES = np.array(RECIPES, np.int64)


class Distances(NamedTuple):
    """What a chef on a cell, looking in a direction, is nearest to. C cells.

    Attributes:
        place: (C, 2) int16  x and y
        walls: (C, 4) uint8  1 where the neighbour is no floor
        nearest: (C, 4, 4) int16  cell of the nearest onion, tomato, dish and serving tile, -1 for none in reach
        pots: (C, 4, 2) int16  the nearest and next pot's index, -1 for none in reach
    """

    place: NDArray[np.int16]
    walls: NDArray[np.uint8]
    nearest: NDArray[np.int16]
    pots: NDArray[np.int16]


def measure(layout: Layout, plan: Plan) -> Distances:
    """Finds the nearest things from everywhere; ties go to the first in row-major order.

    Distance is the number of actions of one chef alone until it faces the thing, turning towards a wall included.
    """
    cells = len(plan.fresh_cells)
    steps = {letter: [_actions_to(plan, cell) for cell in _cells(layout, letter)] for letter in _SOURCES + "P"}
    nearest = np.full((cells, 4, 4), -1, np.int16)
    pots = np.full((cells, 4, _POT_SLOTS), -1, np.int16)
    for column, letter in enumerate(_SOURCES):
        if steps[letter]:
            ranked = np.array(steps[letter])
            nearest[..., column] = np.array(_cells(layout, letter))[ranked.argmin(0)]
            nearest[..., column][ranked.min(0) == _FAR] = -1
    ranked = np.array(steps["P"])
    order = ranked.argsort(0, kind="stable")[:_POT_SLOTS]
    pots[..., : len(order)] = np.moveaxis(np.where(np.take_along_axis(ranked, order, 0) == _FAR, -1, order), 0, -1)
    return Distances(
        place=np.array([(x, y) for y in range(layout.height) for x in range(layout.width)], np.int16),
        walls=(plan.fresh_cells[plan.front] != FLOOR).astype(np.uint8),
        nearest=nearest,
        pots=pots,
    )


_FAR = 2**30


def _cells(layout: Layout, letter: str) -> list[int]:
    return [y * layout.width + x for x, y in layout.positions(letter)]


def _actions_to(plan: Plan, goal: int) -> NDArray[np.int64]:
    """Counts the actions until a chef faces `goal`, by cell and facing: (C, 4), _FAR where it never will."""
    is_floor = (plan.fresh_cells == FLOOR)[:, None]
    steps = np.where(is_floor & (plan.front == goal), 0, _FAR).astype(np.int64)
    while True:
        after = steps[plan.target[:, :4], np.arange(4)].min(1, keepdims=True) + 1
        better = np.where(is_floor, np.minimum(steps, np.minimum(after, _FAR)), _FAR)
        if (better == steps).all():
            return steps
        steps = better


@jit
def write_features(batch: Batch, plan: Plan, near: Distances, out: NDArray[np.float32]) -> None:
    """Writes both chefs' features of N kitchens into out, (N, 2, 96) float32."""
    for i in range(batch.cells.shape[0]):
        for viewer in range(2):
            row = out[i, viewer]
            for k in range(NUM_FEATURES):
                row[k] = 0
            other = 1 - viewer
            _write_block(batch, plan, near, i, viewer, row, 0)
            _write_block(batch, plan, near, i, other, row, _BLOCK)
            own_place, other_place = near.place[batch.position[i, viewer]], near.place[batch.position[i, other]]
            for axis in range(2):
                row[2 * _BLOCK + axis] = other_place[axis] - own_place[axis]
                row[2 * _BLOCK + 2 + axis] = own_place[axis]


@jit
def _write_block(batch: Batch, plan: Plan, near: Distances, i: int, chef: int, row: NDArray[np.float32], first: int) -> None:
    cell, facing, held = batch.position[i, chef], batch.facing[i, chef], batch.held[i, chef]
    row[first + facing] = 1
    if held != NOTHING:
        row[first + 4 + (0 if held == ONION else 1 if held > SOUP else 2 if held == DISH else 3)] = 1
    offsets = (8, 10, 12, 18)
    items = (ONION, TOMATO, DISH, NOTHING)
    for k in range(4):
        target = near.nearest[cell, facing, k]
        if target >= 0 and (held != items[k] or held == NOTHING):
            for axis in range(2):
                row[first + offsets[k] + axis] = near.place[target, axis] - near.place[cell, axis]
    if held > SOUP:
        row[first + 16] = _RECIPES[held - SOUP, 0]
        row[first + 17] = _RECIPES[held - SOUP, 1]
    for slot in range(_POT_SLOTS):
        p = near.pots[cell, facing, slot]
        if p < 0:
            continue
        pot, at = plan.pots[p], first + 22 + 10 * slot
        code = batch.cells[i, pot]
        recipe = code - (POT_READY if code > POT_READY else POT_COOKING if code > POT_COOKING else POT_IDLE)
        row[at] = 1
        row[at + 1] = code == POT_IDLE
        row[at + 2] = code >= POT_IDLE + FIRST_OF_THREE
        row[at + 3] = POT_COOKING < code <= POT_READY
        row[at + 4] = code > POT_READY
        row[at + 5] = _RECIPES[recipe, 0]
        row[at + 6] = _RECIPES[recipe, 1]
        row[at + 7] = batch.remaining[i, p]
        row[at + 8] = near.place[pot, 0] - near.place[cell, 0]
        row[at + 9] = near.place[pot, 1] - near.place[cell, 1]
    for direction in range(4):
        row[first + 22 + 10 * _POT_SLOTS + direction] = near.walls[cell, direction]
