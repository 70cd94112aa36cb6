"""Replays episodes from their joint actions, in a terminal or as a GIF."""

from __future__ import annotations

import shutil
import sys
import time
from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import IO, Any

import numpy as np
from numpy.typing import ArrayLike

from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.rendering.gif import write_gif
from overcooked_bench.rendering.picture import draw
from overcooked_bench.rendering.poster import poster
from overcooked_bench.rendering.text import TILE_WIDTH, film

Frame = tuple[KitchenState, float]
"""A state, and the points (soup reward of both chefs) earned until then."""


class PaceError(WrongUse):
    """An episode cannot be shown at this pace; the message says what to give."""


_UP_AND_CLEAR = "\x1b[{}F\x1b[J"


def frames_of(
    layout: Layout | str | Path,
    initial: KitchenState | Mapping[str, Any],
    actions: ArrayLike,
    cooking: str = "auto",
    horizon: int = 400,
) -> Iterator[Frame]:
    """Replays an episode; the joint actions alone reproduce it.

    Args:
        layout: The floor plan, or what `Layout.load` takes.
        initial: The first state, or its dictionary form (`KitchenState.to_dict`).
        actions: (T, 2) ints, T joint actions.
        cooking: "auto" or "manual", whichever the episode was played in.
        horizon: Steps of the episode.

    Yields:
        T + 1 frames, the initial state first.

    Raises:
        ValueError: Actions of a wrong shape, more of them than the horizon has room for, or a state that is not legal.
    """
    from overcooked_bench.kitchen.kitchens import Kitchens

    state = initial if isinstance(initial, KitchenState) else KitchenState.from_dict(initial)
    joint = np.asarray(actions)
    if joint.ndim != 2 or joint.shape[1] != 2:
        raise ValueError(f"actions have the shape {joint.shape}; give (T, 2), one joint action per row")
    if state.timestep + len(joint) > horizon:
        raise ValueError(
            f"{len(joint)} joint actions from step {state.timestep} go beyond the horizon of {horizon}; "
            "give the horizon the episode was played with"
        )
    kitchens = Kitchens(layout, 1, cooking=cooking, horizon=horizon, autoreset=False)
    kitchens.set_state(0, state)
    points = 0.0
    yield kitchens.state(0), points
    for row in joint:
        points += float(kitchens.step(row[None]).soup_reward.sum())
        yield kitchens.state(0), points


def save_gif(
    path: str | Path,
    layout: Layout,
    frames: Iterable[Frame],
    *,
    tile_size: int = 40,
    every: int = 1,
    fps: float = 8,
    names: tuple[str, str] | None = None,
) -> Path:
    """Writes an episode as an animated GIF that starts over after two seconds.

    Args:
        path: The file.
        layout: The floor plan.
        frames: From `frames_of`.
        tile_size: Pixels.
        every: Keep only every k-th frame, k = `every`, and always the last.
        fps: Frames per second.
        names: Names of the agents on seats 0 and 1.

    Returns:
        The path.

    Raises:
        PaceError: `every` or `fps` out of range.
        ValueError: No frames.
    """
    _expect_pace(every, fps)
    pictures = (
        draw(layout, state, tile_size=tile_size, caption=f"step {state.timestep}   {points:g} points", names=names)
        for state, points in thinned(frames, every)
    )
    return write_gif(path, pictures, fps)


def save_poster_gif(
    path: str | Path,
    kitchens: Sequence[tuple[Layout, Iterable[Frame]]],
    *,
    columns: int = 3,
    tile_size: int = 40,
    every: int = 1,
    fps: float = 8,
) -> Path:
    """Writes several episodes side by side as one animated GIF, each with its layout's name and points.

    Args:
        path: The file.
        kitchens: Pairs of layout and its frames; the animation ends with the shortest episode.
        columns: Kitchens in a row.
        tile_size: Pixels.
        every: Keep only every k-th frame, k = `every`, and always the last.
        fps: Frames per second.

    Returns:
        The path.

    Raises:
        PaceError: `every` or `fps` out of range.
        ValueError: No kitchens or no frames.
    """
    _expect_pace(every, fps)
    layouts = [layout for layout, _ in kitchens]
    names = [layout.name.replace("_", " ") if "\n" not in layout.name else "kitchen" for layout in layouts]
    pictures = (
        poster(
            [(layout, state) for layout, (state, _) in zip(layouts, moment, strict=True)],
            titles=[f"{name}   {points:g} points" for name, (_, points) in zip(names, moment, strict=True)],
            columns=columns,
            tile_size=tile_size,
        )
        for moment in thinned(zip(*(frames for _, frames in kitchens), strict=False), every)
    )
    return write_gif(path, pictures, fps)


def play_in_terminal(
    layout: Layout,
    frames: Iterable[Frame],
    *,
    fps: float = 8,
    every: int = 1,
    names: tuple[str, str] | None = None,
    out: IO[str] | None = None,
) -> float:
    """Shows an episode as text: redrawn in place on a terminal, and only its first and last frame in a file or pipe.

    Args:
        layout: The floor plan.
        frames: From `frames_of`.
        fps: Frames per second; ignored if `out` is not a terminal.
        every: Show only every k-th frame, k = `every`, and always the last.
        names: Names of the agents on seats 0 and 1.
        out: Where to write; standard output by default. A terminal that is too small counts as a file.

    Returns:
        The points at the end.

    Raises:
        PaceError: `every` or `fps` out of range.
        ValueError: No frames.
    """
    _expect_pace(every, fps)
    out = sys.stdout if out is None else out
    columns, rows = shutil.get_terminal_size()
    live = out.isatty() and columns >= TILE_WIDTH * layout.width and rows > layout.height + 2
    head = "   ".join(f"seat {seat}: {name}" for seat, name in enumerate(names or ()))
    first: Frame | None = None
    last: Frame | None = None
    lines = 0
    for last in thinned(frames, every):
        first = first or last
        if live:
            text = _page(layout, last, head, colour=True, most=rows - 1)
            out.write((_UP_AND_CLEAR.format(lines) if lines else "") + text)
            out.flush()
            lines = text.count("\n")
            time.sleep(1 / fps)
    if first is None or last is None:
        raise ValueError("the episode has no frames; give what frames_of yields")
    if not live:
        pages = [_page(layout, frame, head, colour=False) for frame in (first, last)[: 1 + (first is not last)]]
        out.write("\n".join(pages))
    return last[1]


def _page(layout: Layout, frame: Frame, head: str, *, colour: bool, most: int | None = None) -> str:
    state, points = frame
    lines = [f"{head}{'   ' * bool(head)}{points:g} points", *film(layout, state, colour=colour).split("\n")]
    return "\n".join(lines[:most]) + "\n"


def thinned(frames: Iterable[Any], every: int) -> Iterator[Any]:
    """Yields the first frame, then each k-th after it, and always the last."""
    nothing = object()
    held: Any = nothing
    for k, frame in enumerate(frames):
        held = nothing if k % every == 0 else frame
        if held is nothing:
            yield frame
    if held is not nothing:
        yield held


def _expect_pace(every: int, fps: float) -> None:
    if every < 1:
        raise PaceError(f"every={every!r}; give 1 for each frame, 2 for every second one, ...")
    if not 0 < fps <= 50:
        raise PaceError(f"fps={fps!r}; give frames per second, at most 50")
