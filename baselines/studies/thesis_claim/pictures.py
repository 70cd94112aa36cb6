"""The pictures of the result page."""

from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.shown.figures import COLOURS, DIM, INK, Plot
from overcooked_bench.evaluation.shown.ordered_plot import draw_ordered

from .analysis import SMALLEST
from .page import BLOCKS, DIFFERENCES
from .result import Result, Test

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Differences = Mapping[str, NDArray[Any]]
"""Name of a primary comparison -> (n,) its difference in each block."""


def draw(result: Result, per_block: Differences, folder: Path) -> None:
    """Draws all pictures into a folder.

    Args:
        result: Everything.
        per_block: The primary comparisons' differences.
        folder: Where to.
    """
    tests = [*result.primary, *result.null, *(test for test in result.secondary if not test.measure.startswith("h50"))]
    height = 1.2 + 0.24 * len(tests)
    Plot(partial(_forest, tests=tests), (8, height), "differences with their intervals").save(folder / DIFFERENCES)
    Plot(partial(_dots, per_block=per_block), (8, 2.6), "each block's difference").save(folder / BLOCKS)
    for view in result.views:
        draw_ordered(view.figure, view.rule, folder / f"view-{view.layout}.png")


def _forest(picture: "Figure", tests: Sequence[Test]) -> None:
    axes = picture.subplots()
    for at, test in enumerate(tests):
        found, colour = test.found, COLOURS[0] if test.verdict else DIM
        axes.plot([found.low, found.high], [at, at], color=colour, linewidth=2 if test.verdict else 1.2)
        axes.plot(found.value, at, "o", color=colour, markersize=5)
    axes.axvline(0, color=INK, linewidth=0.8)
    axes.axvline(SMALLEST, color=INK, linewidth=0.8, linestyle=":")
    axes.set_yticks(range(len(tests)), [f"{t.first} - {t.second}, {t.measure}, {t.layout}" for t in tests])
    axes.invert_yaxis()
    axes.set_xlabel(f"difference of N (dotted: {SMALLEST:g}, the smallest of interest; the first two decide)")
    axes.grid(axis="x")


def _dots(picture: "Figure", per_block: Differences) -> None:
    axes = picture.subplots()
    for at, values in enumerate(per_block.values()):
        beside = at + np.linspace(-0.25, 0.25, len(values))  # in the order of the blocks
        axes.plot(values, beside, "o", color=COLOURS[at % len(COLOURS)], markersize=4, alpha=0.7)
        axes.plot(values.mean(), at, "|", color=INK, markersize=40)
    axes.axvline(0, color=INK, linewidth=0.8)
    axes.set_yticks(range(len(per_block)), list(per_block))
    axes.invert_yaxis()
    axes.set_xlabel("difference of N in each block; the line is the mean")
    axes.grid(axis="x")
