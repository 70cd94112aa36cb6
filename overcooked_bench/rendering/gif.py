"""Writes small animated GIFs: one palette for all frames, and in each frame only the pixels that changed."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from struct import pack

import numpy as np
from numpy.typing import NDArray

COLOURS = 255
"""Colours all frames share; index 255 stands for an unchanged pixel."""

_EXACT = 64  # the most frequent colours are kept as they are
_LAST_FRAME_MS = 2000
_REPEAT = b"\x21\xff\x0bNETSCAPE2.0\x03\x01\x00\x00\x00"
_KEEP = 1  # disposal: the next frame is drawn over this one


def write_gif(path: str | Path, pictures: Iterable[NDArray[np.uint8]], fps: float) -> Path:
    """Writes pictures of one size as a GIF that repeats forever and pauses on its last frame.

    Args:
        path: The file.
        pictures: (h, w, 3) uint8 each; read one by one.
        fps: Frames per second.

    Returns:
        The path.

    Raises:
        ValueError: There are no pictures.

    Source: the GIF89a specification; the compression itself is Pillow's.
    """
    changes: list[tuple[NDArray[np.intp], NDArray[np.uint32]]] = []
    before = np.zeros((0, 0), np.uint32)
    for picture in pictures:
        now = _packed(picture)
        where = np.flatnonzero(now != before) if before.size else np.arange(now.size)
        changes.append((where, now.ravel()[where]))
        before = now
    if not changes:
        raise ValueError("an animation needs at least one frame")
    colours, counts = np.unique(np.concatenate([new for _, new in changes]), return_counts=True)
    palette = _palette(colours, counts)
    index = _nearest(colours, palette)
    height, width = before.shape
    durations = [1000 / fps] * (len(changes) - 1) + [_LAST_FRAME_MS]
    with Path(path).open("wb") as file:
        file.write(b"GIF89a" + pack("<HHBBB", width, height, 0xF7, 0, 0) + palette.tobytes() + _REPEAT)
        for (where, new), duration in zip(changes, durations, strict=True):
            frame = np.full(height * width, COLOURS, np.uint8)
            frame[where] = index[np.searchsorted(colours, new)]
            file.write(_frame(frame.reshape(height, width), duration))
        file.write(b";")
    return Path(path)


def _frame(indices: NDArray[np.uint8], duration: float) -> bytes:
    """Encodes the smallest rectangle that holds all changes, one pixel where there are none."""
    from PIL import GifImagePlugin, Image

    rows, columns = (np.flatnonzero((indices != COLOURS).any(axis)) for axis in (1, 0))
    top, bottom = (rows[0], rows[-1] + 1) if rows.size else (0, 1)
    left, right = (columns[0], columns[-1] + 1) if columns.size else (0, 1)
    image = Image.fromarray(np.ascontiguousarray(indices[top:bottom, left:right]))
    options = {"duration": duration, "transparency": COLOURS, "disposal": _KEEP, "interlace": 0}
    return b"".join(GifImagePlugin.getdata(image, (int(left), int(top)), **options))


def _packed(picture: NDArray[np.uint8]) -> NDArray[np.uint32]:
    """Returns one number for each pixel's colour, (h, w)."""
    return picture.astype(np.uint32) @ np.array([65536, 256, 1], np.uint32)


def _unpacked(colours: NDArray[np.uint32]) -> NDArray[np.uint8]:
    return np.stack([colours >> 16, colours >> 8 & 255, colours & 255], axis=-1).astype(np.uint8)


def _palette(colours: NDArray[np.uint32], counts: NDArray[np.intp]) -> NDArray[np.uint8]:
    """Chooses 256 colours: the most frequent ones as they are, and a median cut for the rest."""
    from PIL import Image

    by_count = np.argsort(-counts, kind="stable")
    exact, rest = _unpacked(colours[by_count[:_EXACT]]), _unpacked(colours[by_count[_EXACT:]])
    if len(rest) > COLOURS - _EXACT:
        mixed = Image.fromarray(rest[None]).quantize(COLOURS - _EXACT, Image.Quantize.MEDIANCUT)
        rest = np.array(mixed.getpalette(), np.uint8).reshape(-1, 3)[: COLOURS - _EXACT]
    palette = np.zeros((256, 3), np.uint8)
    chosen = np.concatenate([exact, rest])
    palette[: len(chosen)] = chosen
    return palette


def _nearest(colours: NDArray[np.uint32], palette: NDArray[np.uint8]) -> NDArray[np.uint8]:
    """Returns the palette's index of each colour."""
    wanted, offered = _unpacked(colours).astype(np.int32), palette[:COLOURS].astype(np.int32)
    chunks = [wanted[k : k + 1024, None] - offered for k in range(0, len(wanted), 1024)]
    return np.concatenate([(chunk**2).sum(axis=2).argmin(axis=1) for chunk in chunks]).astype(np.uint8)
