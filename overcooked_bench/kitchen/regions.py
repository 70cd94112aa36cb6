"""Finds the separate parts of a kitchen's floor, and which of them can make a soup together."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import permutations
from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import DIRECTIONS, Position, Recipe

_BITS: Final = {tile: 1 << k for k, tile in enumerate("OTDSP")}
_SERVES: Final = _BITS["D"] | _BITS["S"]


def number_regions(floor: Iterable[Position]) -> dict[Position, int]:
    """Numbers the connected parts of the floor: (x, y) -> region, from 0 in row-major order."""
    cells, regions, count = dict.fromkeys(floor), {}, 0
    for cell in cells:
        if cell in regions:
            continue
        edge = [cell]
        while edge:
            x, y = edge.pop()
            if (x, y) in cells and (x, y) not in regions:
                regions[x, y] = count
                edge += [(x + dx, y + dy) for dx, dy in DIRECTIONS]
        count += 1
    return regions


def faced_from(position: Position, regions: Mapping[Position, int]) -> set[int]:
    """Returns the regions whose chefs can face the tile at (x, y)."""
    x, y = position
    return {regions[x + dx, y + dy] for dx, dy in DIRECTIONS if (x + dx, y + dy) in regions}


def able_regions(rows: Sequence[str], regions: Mapping[Position, int], orders: Iterable[Recipe]) -> NDArray[np.bool_]:
    """Finds the pairs of chefs that can cook an order and serve it, handing objects over counters that both face.

    Args:
        rows: The grid.
        regions: The region of each floor cell.
        orders: (onions, tomatoes) of each order.

    Returns:
        (R, R) bool, symmetric: with one chef in the first region and one in the second.
    """
    menu = [sum(_BITS[letter] for letter, n in zip("OT", recipe, strict=True) if n) for recipe in orders]
    faced = [0] * (max(regions.values()) + 1)
    shared: list[tuple[str, set[int]]] = []
    for y, row in enumerate(rows):
        for x, tile in enumerate(row):
            if tile == " ":
                continue
            near = faced_from((x, y), regions)
            for region in near:
                faced[region] |= _BITS.get(tile, 0)
            if len(near) > 1 and tile in "XP":
                shared.append((tile, near))

    def has(tiles: int, wanted: int) -> bool:
        return tiles & wanted == wanted

    def cooks(tiles: int) -> bool:
        return any(has(tiles, letters) for letters in menu)

    alone = np.array([cooks(tiles) and has(tiles, _SERVES | _BITS["P"]) for tiles in faced])
    able: NDArray[np.bool_] = alone[:, None] | alone
    for tile, near in shared:
        for a, b in permutations(near, 2):
            both = faced[a] | faced[b]
            serves = has(both, _SERVES) if tile == "X" else has(faced[a], _SERVES) or has(faced[b], _SERVES)
            able[a, b] |= cooks(both) and serves and has(both, _BITS["P"])
    return able
