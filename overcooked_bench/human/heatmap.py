"""Where chefs stand and what they hand over, as a picture."""

from collections.abc import Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Final

import numpy as np

from overcooked_bench.human.conduct import PER, Conduct
from overcooked_bench.human.shown import RARE, name
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.rendering.picture import draw_layout
from overcooked_bench.rendering.sprites import CHEF_COLOURS

if TYPE_CHECKING:
    from matplotlib.axes import Axes

_INK: Final = "#333333"
_TILE: Final = 48  # pixels
_CELL: Final = 0.5  # inches, like what follows
_HEAD, _FOOT, _GAP = 0.5, 0.55, 0.3
_LEAST: Final = 0.005
"""Share of the time from which a cell's number is written."""

_NOTE: Final = (
    "On the floor: share of the chef's time on the cell, %. In a circle: objects that the chef\n"
    f"puts down there and the other chef picks up, per {PER} steps."
)


def draw_conduct(found: Sequence[Conduct], file: "str | Path | IO[bytes]", form: str = "png") -> None:
    """Draws the floor plan of each layout twice, once per chef, with where the chef stands and what it hands over.

    Args:
        found: What to draw, one layout per row, one at least.
        file: Where to.
        form: "png" or "svg".
    """
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    layouts = [Layout.named(one.layout) for one in found]
    widest = max(5, *(layout.width for layout in layouts))
    width, height = 3 * _GAP + 2 * _CELL * widest, _FOOT + sum(_HEAD + _CELL * layout.height for layout in layouts)
    with matplotlib.rc_context({"svg.hashsalt": "overcooked_bench", "font.size": 8, "font.family": "DejaVu Sans"}):
        figure = Figure(figsize=(width, height), dpi=120)
        FigureCanvasAgg(figure)
        bottom = height
        for one, layout in zip(found, layouts, strict=True):
            bottom -= _HEAD + _CELL * layout.height
            for seat in range(2):
                left = _GAP + seat * (_GAP + _CELL * widest)
                box = left / width, bottom / height, _CELL * layout.width / width, _CELL * layout.height / height
                _draw(figure.add_axes(box), one, layout, seat)
        figure.text(_GAP / width, 0.12 / height, _NOTE, fontsize=7, color=_INK)
        metadata: dict[str, Any] = {"Software": None} if form == "png" else {"Date": None, "Creator": None}
        figure.savefig(file, format=form, metadata=metadata)


def _draw(axes: "Axes", one: Conduct, layout: Layout, seat: int) -> None:
    plan, chef, visits = draw_layout(layout, tile_size=_TILE), one.chefs[seat], one.visits
    extent = (-0.5, layout.width - 0.5, layout.height - 0.5, -0.5)
    axes.imshow(plan, extent=extent, alpha=0.75)
    heat = np.zeros((layout.height, layout.width, 4))
    heat[..., :3] = np.array(CHEF_COLOURS[seat]) / 255
    heat[..., 3] = 0.9 * np.sqrt(visits[seat] / visits.max())
    axes.imshow(heat, extent=extent, interpolation="nearest")
    for (y, x), share in np.ndenumerate(visits[seat]):
        if share >= _LEAST:
            dark = heat[y, x, 3] < 0.6 or seat == 1
            axes.text(x, y, f"{100 * share:.0f}", ha="center", va="center", color="black" if dark else "white")
    handed: dict[tuple[int, int], float] = {}
    for entry in one.handed:
        handed[entry.counter] = handed.get(entry.counter, 0.0) + entry.rates[seat]
    for (x, y), rate in handed.items():
        if rate >= RARE:
            axes.plot(x, y, "o", markersize=19, markerfacecolor="white", markeredgecolor=_INK, markeredgewidth=1.2)
            axes.text(x, y, f"{rate:.1f}", ha="center", va="center", color="black")
    axes.set_axis_off()
    walks = "" if chef.clockwise is None else f", {100 * chef.clockwise:.0f} % clockwise"
    title = f"{name(one.layout)}\nchef {seat}: idle {100 * chef.idle:.0f} %{walks}"
    axes.set_title(title, fontsize=8, loc="left", color=_INK)
