"""A cross-play matrix as a picture."""

from functools import partial
from itertools import groupby
from pathlib import Path
from typing import IO, TYPE_CHECKING, Final

import numpy as np

from overcooked_bench.evaluation.pools.crossplay import CrossPlay
from overcooked_bench.evaluation.shown.figures import COLOURS, Plot

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_MOST_NUMBERED: Final = 20
"""Agents at most for numbers in the cells to be readable."""
_FRAME: Final = COLOURS[1]


def draw_heat_map(found: CrossPlay, file: "str | Path | IO[bytes]", form: str = "png") -> None:
    """Draws the matrix: seat 0 downwards, seat 1 to the right, self-play on the framed diagonal.

    Args:
        found: What to draw.
        file: Where to.
        form: "png" or "svg".
    """
    count = len(found.means)
    inches = max(4.4, (0.42 if count <= _MOST_NUMBERED else 0.24) * count + 2.2)
    Plot(partial(_paint, found=found), (inches + 0.8, inches), _title(found)).save(file, form)


def _paint(figure: "Figure", found: CrossPlay) -> None:
    from matplotlib.patches import Rectangle

    means = np.array(found.means)
    size, names = len(means), [agent.name for agent in found.agents]
    axes = figure.subplots()
    top = float(max(20.0, means.max()))
    image = axes.imshow(means, cmap="cividis", vmin=0, vmax=top)
    axes.set_xticks(range(size), names, rotation=90)
    axes.set_yticks(range(size), names)
    axes.set_xlabel("seat 1")
    axes.set_ylabel("seat 0")
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    if size <= _MOST_NUMBERED:
        for (y, x), mean in np.ndenumerate(means):
            colour = "#000000" if mean > 0.55 * top else "#ffffff"
            axes.text(x, y, f"{mean:.0f}", ha="center", va="center", color=colour, fontsize=7)
    for first, count in _families(found):
        corner = first - 0.5, first - 0.5
        axes.add_patch(Rectangle(corner, count, count, fill=False, edgecolor=_FRAME, linewidth=1.6, clip_on=False))
    figure.colorbar(image, ax=axes, shrink=0.8, label="points per episode")
    figure.suptitle(_title(found), fontsize=9, x=0.02, ha="left")


def _families(found: CrossPlay) -> list[tuple[int, int]]:
    """Returns (first index, size) of each run of neighbours of one lineage."""
    families, first = [], 0
    for _, group in groupby(agent.lineage for agent in found.agents):
        count = len(list(group))
        families.append((first, count))
        first += count
    return families


def _title(found: CrossPlay) -> str:
    ratio = f"ratio {found.ratio.text(2)}" if found.ratio else "no ratio"
    return (
        f"{found.layout}, pool {found.pool.name}, {found.episodes} episodes per cell\n"
        f"with itself {found.self_play.text(0)}, with strangers {found.cross_play.text(0)}\n{ratio}"
    )
