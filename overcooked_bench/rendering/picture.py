"""Draws a kitchen as a picture."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState, Soup
from overcooked_bench.rendering import sprites
from overcooked_bench.rendering.caption import caption_height, status_line
from overcooked_bench.rendering.pots import progress

Image = NDArray[np.uint8]
"""(h, w, 3) uint8."""

SMALLEST_TILE = 8


def draw(
    layout: Layout,
    state: KitchenState,
    *,
    tile_size: int = 48,
    caption: str | None = None,
    names: tuple[str, str] | None = None,
) -> Image:
    """Draws a kitchen.

    Args:
        layout: The floor plan.
        state: The chefs and objects to draw.
        tile_size: Pixels, at least 8.
        caption: Text of a slim line below the kitchen, such as the step and the points; None for no line.
        names: Names of the agents on seats 0 and 1, written in that line next to the chefs' colours.

    Returns:
        (h, w, 3) uint8: h = H * tile_size, plus `caption_height(tile_size)` if there is a line, w = W * tile_size.

    Raises:
        ValueError: The tiles are too small to draw, or the state does not fit the layout.
    """
    image = draw_layout(layout, tile_size=tile_size)
    for position in layout.positions("P"):
        _put(image, _pot(layout, state, position, tile_size), position, tile_size)
    for position, what in state.objects.items():
        _expect_inside(layout, position)
        if layout.tile(position) != "P":
            _put(image, sprites.lying(what, tile_size), position, tile_size)
    for seat, chef in enumerate(state.chefs):
        _expect_inside(layout, chef.position)
        _put(image, sprites.chef(seat, chef.facing, chef.holding, tile_size), chef.position, tile_size)
    if caption is None and names is None:
        return image
    return np.concatenate([image, status_line(image.shape[1], caption_height(tile_size), caption or "", names)])


def draw_layout(layout: Layout, *, tile_size: int = 48) -> Image:
    """Draws a kitchen without chefs and objects: floor, counters, dispensers, empty pots and serving tiles.

    Args:
        layout: The floor plan.
        tile_size: Pixels, at least 8.

    Returns:
        (H * tile_size, W * tile_size, 3) uint8.

    Raises:
        ValueError: The tiles are too small to draw.
    """
    if tile_size < SMALLEST_TILE:
        raise ValueError(f"tile_size={tile_size!r}; give at least {SMALLEST_TILE} pixels")
    image = _background(layout.rows, tile_size).copy()
    for position in layout.positions("P"):
        _put(image, sprites.pot((0, 0), -1, -1, tile_size), position, tile_size)
    return image


def _expect_inside(layout: Layout, position: tuple[int, int]) -> None:
    x, y = position
    if not (0 <= x < layout.width and 0 <= y < layout.height):
        raise ValueError(f"the state has something at {position}; the layout is {layout.width} x {layout.height} cells")


def _pot(layout: Layout, state: KitchenState, position: tuple[int, int], tile_size: int) -> Image:
    content = state.objects.get(position)
    if not isinstance(content, Soup):
        return sprites.pot((0, 0), -1, -1, tile_size)
    tick, cook_time = progress(layout, content) or (-1, -1)
    return sprites.pot(content.recipe, tick, cook_time, tile_size)


@lru_cache(maxsize=32)
def _background(rows: tuple[str, ...], tile_size: int) -> Image:
    """Draws what never changes: floor, counters, dispensers and serving tiles."""
    from PIL import Image as Pictures
    from PIL import ImageDraw

    t, height, width = tile_size, len(rows), len(rows[0])
    picture = Pictures.new("RGB", (width * t, height * t), sprites.COUNTER)
    pen = ImageDraw.Draw(picture)
    thin, lip = max(1, round(t / 32)), max(1, round(0.1 * t))
    for y in range(height):
        for x in range(width):
            left, top, right, bottom = x * t, y * t, (x + 1) * t - 1, (y + 1) * t - 1
            if rows[y][x] == " ":
                pen.rectangle((left, top, right, bottom), sprites.FLOORS[(x + y) % 2])
                if rows[y][x - 1] != " ":
                    pen.rectangle((left, top, left + thin, bottom), sprites.COUNTER_SHADOW)
                if rows[y - 1][x] != " ":
                    pen.rectangle((left, top, right, top + 2 * lip), sprites.COUNTER_SHADOW)
                    pen.rectangle((left, top, right, top + lip), sprites.COUNTER_FRONT)
            else:
                pen.rectangle((left, top, right, bottom), sprites.COUNTER, sprites.COUNTER_JOINT, thin)
                pen.rectangle((left, top, right, top + thin - 1), sprites.COUNTER_LIGHT)
    image = np.array(picture)
    for y in range(height):
        for x in range(width):
            if rows[y][x] not in " X":
                _put(image, sprites.fixture(rows[y][x], t), (x, y), t)
    image.setflags(write=False)
    return image


def _put(image: Image, sprite: Image, position: tuple[int, int], tile_size: int) -> None:
    """Draws a translucent sprite (s, s, 4) over the picture, centred on a cell."""
    size = sprite.shape[0]
    margin = (size - tile_size) // 2
    left, top = position[0] * tile_size - margin, position[1] * tile_size - margin
    patch = image[top : top + size, left : left + size]
    opacity = sprite[..., 3:].astype(np.uint16)
    patch[:] = (sprite[..., :3] * opacity + patch * (255 - opacity) + 127) // 255
