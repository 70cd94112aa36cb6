"""Lines of text below a kitchen."""

from __future__ import annotations

from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.rendering.brush import Brush, Colour, font_of
from overcooked_bench.rendering.sprites import CHEF_COLOURS, WHITE

if TYPE_CHECKING:
    from PIL.Image import Image
    from PIL.ImageDraw import ImageDraw

GROUND: Colour = (38, 44, 50)
_LEAST_FONT = 7


def caption_height(tile_size: int) -> int:
    """Returns the height of a line below a kitchen, pixels."""
    return max(14, round(0.5 * tile_size))


def status_line(width: int, height: int, caption: str, names: tuple[str, str] | None = None) -> NDArray[np.uint8]:
    """Writes the chefs' names next to their colours, and the caption on the right, or on the left without names.

    Text that does not fit shrinks; then the names are left out, then the caption is cut.

    Returns:
        (height, width, 3) uint8.
    """
    picture, pen = _blank(width, height)
    pad = round(height / 3)
    for shown in (names, None):
        for size in range(round(0.62 * height), _LEAST_FONT - 1, -1):
            dots = [(name, pen.textlength(name, font_of(size)) + 1.5 * size) for name in shown or ()]
            length = pen.textlength(caption, font_of(size))
            if sum(length + pad for _, length in dots) + length + 2 * pad <= width:
                _write(pen, height, pad, size, caption, width - pad - length if dots else pad, dots)
                return np.array(picture)
    while caption and pen.textlength(caption + "…", font_of(_LEAST_FONT)) + 2 * pad > width:
        caption = caption[:-1]
    _write(pen, height, pad, _LEAST_FONT, caption + "…", pad, [])
    return np.array(picture)


@lru_cache(maxsize=256)
def title_line(width: int, height: int, title: str) -> NDArray[np.uint8]:
    """Writes a title in the middle of a line, (height, width, 3) uint8."""
    picture, pen = _blank(width, height)
    size = round(0.66 * height)
    while size > _LEAST_FONT and pen.textlength(title, font_of(size)) > width:
        size -= 1
    _write(pen, height, 0, size, title, (width - pen.textlength(title, font_of(size))) / 2, [])
    return np.array(picture)


def _blank(width: int, height: int) -> tuple[Image, ImageDraw]:
    from PIL import Image, ImageDraw

    picture = Image.new("RGB", (width, height), GROUND)
    return picture, ImageDraw.Draw(picture)


def _write(
    pen: ImageDraw, height: int, pad: int, size: int, caption: str, left: float, dots: list[tuple[str, float]]
) -> None:
    """Writes names with dots from the left, (name, length in pixels) each, and the caption at `left`."""
    x = float(pad)
    for seat, (name, length) in enumerate(dots):
        pen.bitmap((round(x), (height - size) // 2), _disc(size, 1.0), WHITE)
        pen.bitmap((round(x), (height - size) // 2), _disc(size, 0.8), CHEF_COLOURS[seat])
        pen.text((x + 1.5 * size, height / 2), name, WHITE, font_of(size), "lm")
        x += length + pad
    pen.text((left, height / 2), caption, WHITE, font_of(size), "lm")


@lru_cache(maxsize=64)
def _disc(size: int, share: float) -> Image:
    """Returns a smooth disc's opacity, (size, size)."""
    from PIL import Image

    brush = Brush(size)
    brush.disc(0.5, 0.5, share / 2, WHITE)
    return Image.fromarray(brush.finish()[..., 3])
