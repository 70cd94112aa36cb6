"""Precomputed tables of a layout for the scripted planners: ways, regions, recipes.

Axes: C = H x W cells in row-major order, R regions of the floor.
"""

from collections.abc import Sequence
from functools import lru_cache
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import DIRECTIONS, MAX_INGREDIENTS, RECIPES
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.tracks.ring import find_middle

FAR: Final = 10_000
"""Steps to a cell that cannot be reached."""

FLOOR, COUNTER, POT, SERVING, ONIONS, TOMATOES, DISHES = range(7)
NOTHING, ONION, TOMATO, DISH, SOUP = range(5)
# What a planner does with an item at a counter: nothing, since it uses another; hands it over to the next region;
# passes it on within its own region, where it is taken from the other side.
ELSEWHERE, HANDS_OVER, PASSES = range(3)

# Rows of `LayoutTables.grid`: the tile of a cell; the region of a floor cell; from a floor cell the next cell in each
# direction, or -1 if it is not floor; the same with tiles only; and what a step in each direction counts.
TILE, REGION, NEXT, BESIDE, COST, GRID_ROWS = 0, 1, 2, 6, 10, 14
# Rows of `LayoutTables.onward[r]`: by item, steps from a tile to where chefs of region r take the item; then the cost
# of waiting on a floor cell; then two flags in the cells 0 and 1: whether the region reaches a pot, and a serving tile.
WAITING, FLAGS, ONWARD_ROWS = 5, 6, 7

_MOST_CELLS: Final = 160  # in larger kitchens plans ignore the partner: the table would take more than 8 MB
_BY_A_POT, _BY_A_TILE = 8, 4  # extra steps accepted to wait out of the way
_AGAINST: Final = 4  # what a step against the preferred direction counts
_NEAR: Final = 3  # weight of being near the pots relative to the way there


class LayoutTables(NamedTuple):
    """A layout in tables.

    Attributes:
        grid: (14, C) int64  see the rows above
        ways: (C, C) int64  steps from a floor cell to a floor cell, or to the nearest cell next to a tile
        around: (C or 1, C, C) int64  the same by the cell that the partner blocks; in large kitchens without the
            partner
        onward: (R, 7, C) int64  see the rows above
        wanted: (4, 4, 2) int64  what a pot should become, by the onions and tomatoes in it
    """

    grid: NDArray[np.int64]
    ways: NDArray[np.int64]
    around: NDArray[np.int64]
    onward: NDArray[np.int64]
    wanted: NDArray[np.int64]


@lru_cache(maxsize=32)
def make_tables(layout: Layout, turn: int = 0) -> LayoutTables:
    """Computes the tables of a layout; cached, so they must not be changed.

    Args:
        layout: A layout.
        turn: The direction around the block of counters in the middle, or else around the middle of each region, in
            which steps count 1, while steps against it count more: 1 clockwise as seen from above, -1 anticlockwise; 0
            for 1 in both.
    """
    kinds = dict(zip(" XPSOTD", (FLOOR, COUNTER, POT, SERVING, ONIONS, TOMATOES, DISHES), strict=True))
    tiles = np.array([kinds[tile] for row in layout.rows for tile in row], np.int64)
    cells, width = len(tiles), layout.width
    grid = np.full((GRID_ROWS, cells), -1, np.int64)
    grid[TILE] = tiles
    for (x, y), region in layout.regions.items():
        grid[REGION, y * width + x] = region
        for direction, (dx, dy) in enumerate(DIRECTIONS):
            n = (y + dy) * width + x + dx
            grid[(NEXT if tiles[n] == FLOOR else BESIDE) + direction, y * width + x] = n
    grid[COST:] = _costs(layout, turn) if turn else 1
    beside = _beside(tiles, width)
    ways = _ways(grid, beside, -1)
    around = ways[None]
    if cells <= _MOST_CELLS:
        around = np.stack([_ways(grid, beside, c) if tiles[c] == FLOOR else ways for c in range(cells)])
    regions = range(grid[REGION].max() + 1)
    reach = np.stack([(ways[grid[REGION] == region] < FAR).any(axis=0) for region in regions])
    onward = np.stack([_onward(tiles, width, grid[REGION], ways, beside, reach, region) for region in regions])
    has_onions, has_tomatoes = bool((tiles == ONIONS).any()), bool((tiles == TOMATOES).any())
    return LayoutTables(grid, ways, around, onward, targets(layout.soup_rewards, has_onions, has_tomatoes))


def targets(rewards: Sequence[float], onions: bool, tomatoes: bool) -> NDArray[np.int64]:
    """Computes what each content of a pot should become.

    That is the best paid order that can be reached by adding available ingredients, the smallest in a tie. If there is
    none, it is a full pot of anything, which is cooked and served for no reward to free the pot.

    Args:
        rewards: Reward points of a soup by recipe index, 0 if it is not ordered (`Layout.soup_rewards`).
        onions: Whether there are onions to add.
        tomatoes: Whether there are tomatoes to add.

    Returns:
        (4, 4, 2) int64: [onions in the pot, tomatoes in the pot] -> (onions, tomatoes) wanted.
    """
    sides = MAX_INGREDIENTS + 1
    wanted = np.zeros((sides, sides, 2), np.int64)
    ranked = sorted(zip(RECIPES, rewards, strict=True), key=lambda entry: (-entry[1], sum(entry[0]), entry[0]))
    for o in range(sides):
        for t in range(sides - o):
            wanted[o, t] = (MAX_INGREDIENTS - t, t) if onions else (o, MAX_INGREDIENTS - o)
            for (a, b), reward in ranked:
                if reward > 0 and a >= o and b >= t and (onions or a == o) and (tomatoes or b == t):
                    wanted[o, t] = a, b
                    break
    return wanted


def _beside(tiles: NDArray[np.int64], width: int) -> list[list[int]]:
    """Lists the floor cells from which each cell is reached: a floor cell itself, a tile's neighbours."""
    where = []
    for c, tile in enumerate(tiles):
        near = [n for n in (c - width, c + width, c + 1, c - 1) if 0 <= n < len(tiles) and tiles[n] == FLOOR]
        where.append([c] if tile == FLOOR else near)
    return where


def _costs(layout: Layout, turn: int) -> NDArray[np.int64]:
    """Computes what a step from each cell in each direction counts, (4, C): 1, or more against the preferred turn."""
    costs = np.ones((len(DIRECTIONS), layout.height * layout.width), np.int64)
    block, cells = find_middle(layout), np.array(list(layout.regions))
    regions = np.array(list(layout.regions.values()))
    for (x, y), region in layout.regions.items():
        middle_x, middle_y = block or cells[regions == region].mean(axis=0)
        for direction, (dx, dy) in enumerate(DIRECTIONS):
            turned = (x - middle_x) * dy - (y - middle_y) * dx  # y points downwards: above 0 is clockwise
            costs[direction, y * layout.width + x] = _AGAINST if turn * turned < 0 else 1
    return costs


def _ways(grid: NDArray[np.int64], beside: list[list[int]], blocked: int) -> NDArray[np.int64]:
    """Computes the steps from each floor cell to each cell without crossing the blocked one (-1 for none)."""
    from overcooked_bench.agents.planner.distances import walk  # compiled, which reading a behaviour need not wait for

    cells = grid.shape[1]
    ways = np.full((cells, cells), FAR, np.int64)
    walk(grid[TILE], grid[NEXT:BESIDE], grid[COST:], blocked, np.empty((2, cells), np.int64), ways)
    for c, near in enumerate(beside):
        if grid[TILE, c] != FLOOR and near:
            ways[:, c] = ways[:, near].min(axis=1)
    return ways


def _onward(
    tiles: NDArray[np.int64],
    width: int,
    regions: NDArray[np.int64],
    ways: NDArray[np.int64],
    beside: list[list[int]],
    reach: NDArray[np.bool_],
    region: int,
) -> NDArray[np.int64]:
    """Works out the rows of one region; `reach`, (R, C), says which cells each region reaches."""
    own, in_reach = np.flatnonzero(regions == region), reach[region]
    shared = in_reach & (tiles == COUNTER) & (reach.sum(axis=0) > 1)
    pots, serving = in_reach & (tiles == POT), in_reach & (tiles == SERVING)
    food_goes = pots if pots.any() else shared
    rows = np.full((ONWARD_ROWS, len(tiles)), FAR, np.int64)
    for item, goes in (
        (ONION, food_goes),
        (TOMATO, food_goes),
        (DISH, food_goes),
        (SOUP, serving if serving.any() else shared),
    ):
        steps = ways[:, goes].min(axis=1, initial=FAR)
        for c in np.flatnonzero(in_reach):
            rows[item, c] = min(steps[n] for n in beside[c] if regions[n] == region)
    rows[WAITING] = _NEAR * ways[:, food_goes].min(axis=1, initial=FAR)
    for c in own:
        near = [k for k in (c - width, c + width, c + 1, c - 1) if tiles[k] > COUNTER]
        worst = max((_BY_A_POT if tiles[k] == POT else _BY_A_TILE for k in near), default=0)
        rows[WAITING, c] += worst if len(reach) == 1 else 0
    rows[FLAGS, :2] = pots.any(), serving.any()
    return rows
