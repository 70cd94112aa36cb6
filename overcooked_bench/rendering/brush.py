"""`Brush`: smooth vector shapes in units of one tile, drawn large and scaled down."""

from __future__ import annotations

from functools import lru_cache
from math import ceil
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

if TYPE_CHECKING:
    from PIL.ImageFont import FreeTypeFont, ImageFont

Colour = tuple[int, ...]
"""(red, green, blue), optionally with opacity, each 0 to 255."""

Point = tuple[float, float]

_LEAST_PIXELS = 240  # drawn width of a tile before it is scaled down


class Brush:
    """Draws one tile on a transparent ground.

    Coordinates run from 0 to 1 over the tile, x to the right and y downwards; a margin around it has room for what
    sticks out. A shape replaces what is under it, so only the first shapes may be translucent.

    Args:
        tile_size: Width of the finished tile, pixels.
        margin: Room on each side, tiles; rounded up to whole pixels.
    """

    def __init__(self, tile_size: int, margin: float = 0.0) -> None:
        from PIL import Image, ImageDraw

        self._shrink = max(4, ceil(_LEAST_PIXELS / tile_size))
        self._scale = tile_size * self._shrink
        self._margin = ceil(tile_size * margin)
        self._size = tile_size + 2 * self._margin
        self._image = Image.new("RGBA", (self._size * self._shrink,) * 2)
        self._draw = ImageDraw.Draw(self._image)

    def disc(
        self, x: float, y: float, r: float, fill: Colour, edge: Colour | None = None, width: float = 0.025
    ) -> None:
        """Draws a circle of radius r about (x, y); the edge is inside it."""
        self.oval(x, y, r, r, fill, edge, width)

    def oval(
        self, x: float, y: float, rx: float, ry: float, fill: Colour, edge: Colour | None = None, width: float = 0.025
    ) -> None:
        """Draws an ellipse about (x, y); the edge is inside it."""
        if edge is not None:
            self._draw.ellipse(self._corners(x - rx, y - ry, x + rx, y + ry), edge)
            rx, ry = rx - width, ry - width
        self._draw.ellipse(self._corners(x - rx, y - ry, x + rx, y + ry), fill)

    def box(self, x0: float, y0: float, x1: float, y1: float, fill: Colour, radius: float = 0.0) -> None:
        """Draws a rectangle with rounded corners."""
        self._draw.rounded_rectangle(self._corners(x0, y0, x1, y1), radius * self._scale, fill)

    def shape(self, points: list[Point], fill: Colour) -> None:
        """Draws a filled polygon."""
        self._draw.polygon([self._pixel(*point) for point in points], fill)

    def line(self, points: list[Point], fill: Colour, width: float) -> None:
        """Draws a line with round ends and corners."""
        self._draw.line([self._pixel(*point) for point in points], fill, round(width * self._scale))
        for x, y in points:
            self.disc(x, y, width / 2, fill)

    def arc(self, x: float, y: float, r: float, share: float, fill: Colour, width: float) -> None:
        """Draws a ring's share (0 to 1) of outer radius r, clockwise from the top."""
        box = self._corners(x - r, y - r, x + r, y + r)
        self._draw.arc(box, -90, -90 + 360 * share, fill, round(width * self._scale))

    def text(self, x: float, y: float, text: str, size: float, fill: Colour, edge: Colour) -> None:
        """Writes an outlined text about (x, y)."""
        font: Any = font_of(round(size * self._scale))
        stroke = round(0.09 * size * self._scale)
        self._draw.text(self._pixel(x, y), text, fill, font, "mm", stroke_width=stroke, stroke_fill=edge)

    def finish(self) -> NDArray[np.uint8]:
        """Returns the picture, (size, size, 4) uint8 with size = tile + 2 margins."""
        from PIL import Image

        return np.asarray(self._image.resize((self._size, self._size), Image.Resampling.LANCZOS))

    def _pixel(self, x: float, y: float) -> Point:
        offset = self._margin * self._shrink
        return offset + x * self._scale, offset + y * self._scale

    def _corners(self, x0: float, y0: float, x1: float, y1: float) -> tuple[float, float, float, float]:
        left, top = self._pixel(x0, y0)
        right, bottom = self._pixel(x1, y1)
        return left, top, max(left, right - 1), max(top, bottom - 1)


@lru_cache(maxsize=64)
def font_of(pixels: int) -> FreeTypeFont | ImageFont:
    """Returns Pillow's own font, which is the same on every machine."""
    from PIL import ImageFont

    return ImageFont.load_default(max(4, pixels))
