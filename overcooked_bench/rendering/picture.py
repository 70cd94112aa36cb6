"""The kitchen as a picture: `draw` one state, `poster` several side by side."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import ceil

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import RECIPES
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState, Soup
from overcooked_bench.rendering import sprites
from overcooked_bench.rendering.brush import Colour, font_of

Image = NDArray[np.uint8]
"""(h, w, 3) uint8."""

SMALLEST_TILE = 8
INK: Colour = (38, 44, 50)
PAPER: Colour = (255, 255, 255)


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
        state: Who stands where with what, and what lies where.
        tile_size: Pixels, at least 8.
        caption: Text of a slim line below the kitchen, such as the step and the points; no line where None.
        names: Who sits on seats 0 and 1, written in that line beside the chefs' colours.

    Returns:
        (h, w, 3) uint8: h = H * tile_size (and the line's `caption_height`), w = W * tile_size.

    Raises:
        ValueError: The tiles are too small to draw, or the state does not fit the layout.
    """
    if tile_size < SMALLEST_TILE:
        raise ValueError(f"tile_size={tile_size!r}; give at least {SMALLEST_TILE} pixels")
    image = _background(layout.rows, tile_size).copy()
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
    return np.concatenate([image, _line(image.shape[1], tile_size, caption or "", names)])


def caption_height(tile_size: int) -> int:
    """Gives the height of the caption's line, pixels."""
    return max(14, round(0.5 * tile_size))


def _expect_inside(layout: Layout, position: tuple[int, int]) -> None:
    x, y = position
    if not (0 <= x < layout.width and 0 <= y < layout.height):
        raise ValueError(f"the state has something at {position}; the layout is {layout.width} x {layout.height} cells")


def _pot(layout: Layout, state: KitchenState, position: tuple[int, int], tile_size: int) -> Image:
    content = state.objects.get(position)
    if not isinstance(content, Soup):
        return sprites.pot((0, 0), -1, -1, tile_size)
    cook_time = content.cook_time
    if content.tick >= 0 and cook_time < 0:
        cook_time = layout.cook_times[RECIPES.index(content.recipe)]
    return sprites.pot(content.recipe, min(content.tick, cook_time), cook_time, tile_size)


@lru_cache(maxsize=32)
def _background(rows: tuple[str, ...], tile_size: int) -> Image:
    """Draws what never changes: floor, counters and what stands on them for good."""
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
    """Lays a translucent sprite (s, s, 4) over the picture, its middle on the middle of a cell."""
    size = sprite.shape[0]
    margin = (size - tile_size) // 2
    left, top = position[0] * tile_size - margin, position[1] * tile_size - margin
    patch = image[top : top + size, left : left + size]
    opacity = sprite[..., 3:].astype(np.uint16)
    patch[:] = (sprite[..., :3] * opacity + patch * (255 - opacity) + 127) // 255


def _line(width: int, tile_size: int, caption: str, names: tuple[str, str] | None) -> Image:
    """Writes the line below the kitchen."""
    from PIL import Image as Pictures
    from PIL import ImageDraw

    height = caption_height(tile_size)
    picture = Pictures.new("RGB", (width, height), INK)
    pen = ImageDraw.Draw(picture)
    pad, size = ceil(height / 3), round(0.62 * height)
    parts: list[tuple[str, Colour | None]] = [(name, c) for name, c in zip(names or (), sprites.CHEF_COLOURS, strict=False)]
    parts += [(caption, None)] if caption else []
    while True:
        font = font_of(size)
        dot = round(0.8 * size)
        lengths = [pen.textlength(text, font) + (dot + pad // 2 if c else 0) for text, c in parts]
        total = sum(lengths) + pad * (len(parts) + 1)
        if total <= width or size <= 7:
            break
        size -= 1
    x = float(pad)
    for (text, colour), length in zip(parts, lengths, strict=True):
        if colour is None and len(parts) > 1:
            x = max(x, width - pad - length)
        start = x
        if colour:
            pen.ellipse((x, (height - dot) / 2, x + dot, (height + dot) / 2), colour)
            start += dot + pad // 2
        pen.text((start, height / 2), text, PAPER, font, "lm")
        x += length + pad
    return np.array(picture)


def poster(kitchens: Sequence[tuple[Layout, KitchenState]], *, tile_size: int = 40) -> Image:
    """Draws several kitchens side by side, each above its name.

    Args:
        kitchens: Pairs of layout and state, from left to right.
        tile_size: Pixels.

    Returns:
        (h, w, 3) uint8, on white.
    """
    gap, line = round(0.6 * tile_size), caption_height(tile_size)
    tall = max(layout.height for layout, _ in kitchens) * tile_size
    width = sum(layout.width * tile_size + gap for layout, _ in kitchens) - gap
    image = np.full((tall + line, width, 3), 255, np.uint8)
    left = 0
    for layout, state in kitchens:
        part = draw(layout, state, tile_size=tile_size)
        h, w = part.shape[:2]
        image[tall - h : tall, left : left + w] = part
        image[tall:, left : left + w] = _title(layout.name, w, line)
        left += w + gap
    return image


@lru_cache(maxsize=64)
def _title(name: str, width: int, height: int) -> Image:
    from PIL import Image as Pictures
    from PIL import ImageDraw

    picture = Pictures.new("RGB", (width, height), PAPER)
    title = name.replace("_", " ") if "\n" not in name else ""
    ImageDraw.Draw(picture).text((width / 2, 0.55 * height), title, INK, font_of(round(0.66 * height)), "mm")
    return np.array(picture)
