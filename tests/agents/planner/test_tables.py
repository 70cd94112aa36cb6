"""What the planner knows of a layout, on random kitchens and on the largest."""

import time
from collections import deque

import numpy as np
from hypothesis import given

from overcooked_bench import Layout
from overcooked_bench.agents.planner.tables import FAR, make_tables
from tests.kitchen.strategies import law, layouts


def walked(layout, start, blocked=None):
    """Steps from a floor cell to every cell, or to the nearest floor cell beside a tile, by plain search."""
    steps, edge = {start: 0}, deque([start])
    while edge:
        x, y = edge.popleft()
        for cell in ((x, y - 1), (x, y + 1), (x + 1, y), (x - 1, y)):
            if layout.tile(cell) == " " and cell != blocked and cell not in steps:
                steps[cell] = steps[x, y] + 1
                edge.append(cell)
    found = []
    for y in range(layout.height):
        for x in range(layout.width):
            beside = [(x, y)] if layout.tile((x, y)) == " " else [(x, y - 1), (x, y + 1), (x + 1, y), (x - 1, y)]
            found.append(min(steps.get(cell, FAR) for cell in beside))
    return found


@law
@given(layouts())
def test_ways_are_the_shortest_and_around_leaves_the_blocked_cell_out(layout):
    tables = make_tables(layout)
    for x, y in layout.regions:
        start = y * layout.width + x
        np.testing.assert_array_equal(tables.ways[start], walked(layout, (x, y)))
        for bx, by in layout.regions:
            np.testing.assert_array_equal(
                tables.around[by * layout.width + bx, start], walked(layout, (x, y), blocked=(bx, by))
            )


def test_a_large_open_kitchen_is_planned_in_a_few_seconds():
    rows = ["X" * 64, *["X" + " " * 62 + "X"] * 62, "XOPDS" + "X" * 59]
    began = time.perf_counter()
    tables = make_tables(Layout.from_text("\n".join(rows)))
    assert time.perf_counter() - began < 6
    assert tables.ways[65, 64 * 62 + 62] == 61 + 61
