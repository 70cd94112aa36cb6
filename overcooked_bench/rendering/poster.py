"""Draws several kitchens in one picture."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.rendering.caption import GROUND, caption_height, title_line
from overcooked_bench.rendering.picture import draw


def poster(
    kitchens: Sequence[tuple[Layout, KitchenState]],
    *,
    titles: Sequence[str] | None = None,
    columns: int = 3,
    tile_size: int = 40,
) -> NDArray[np.uint8]:
    """Draws kitchens in rows, each above its title; kitchens that do not fill a row are centred.

    Args:
        kitchens: Pairs of layout and state, from left to right and top to bottom.
        titles: One for each kitchen; the layouts' names by default.
        columns: Kitchens in a row.
        tile_size: Pixels.

    Returns:
        (h, w, 3) uint8.

    Raises:
        ValueError: No kitchens, or not one title for each.
    """
    if not kitchens:
        raise ValueError("a poster needs at least one kitchen; give pairs of layout and state")
    titles = titles or [layout.name.replace("_", " ") if "\n" not in layout.name else "" for layout, _ in kitchens]
    line, gap = caption_height(tile_size), round(tile_size / 2)
    pictures = [
        np.concatenate([picture, title_line(picture.shape[1], line, title)])
        for picture, title in zip((draw(*kitchen, tile_size=tile_size) for kitchen in kitchens), titles, strict=True)
    ]
    rows = [pictures[k : k + columns] for k in range(0, len(pictures), columns)]
    width = max(sum(picture.shape[1] + gap for picture in row) for row in rows) + gap
    heights = [max(picture.shape[0] for picture in row) for row in rows]
    image = np.full((gap + sum(heights) + (gap // 2) * len(rows), width, 3), GROUND, np.uint8)
    top = gap
    for row, height in zip(rows, heights, strict=True):
        left = (width - sum(picture.shape[1] + gap for picture in row) + gap) // 2
        for picture in row:
            h, w = picture.shape[:2]
            image[top + height - h : top + height, left : left + w] = picture
            left += w + gap
        top += height + gap // 2
    return image
