"""The ordered curve as a picture."""

import re
from itertools import product
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any, Final

from overcooked_bench.evaluation.scores import LayoutFacts, Scores
from overcooked_bench.kitchen.menu import DEFAULT_SOUP_REWARD

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS: Final = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#000000", "#E69F00", "#56B4E9")
"""Seven colours that people with any colour vision can distinguish.

Source: Okabe and Ito 2008, "Color Universal Design".
"""
_MARKERS: Final = ("o", "s", "^", "D", "v", "P", "X")
_INK: Final = "#333333"
_STYLE: Final[Any] = {
    "svg.hashsalt": "overcooked_bench",
    "font.size": 10,
    "font.family": "DejaVu Sans",
    "text.parse_math": False,  # a file's name may hold dollar signs
    **dict.fromkeys(("text.color", "xtick.color", "ytick.color", "axes.edgecolor"), _INK),
}
_BY_THEME: Final = {
    _INK: "currentColor",
    "#000000": "currentColor",
    "#666666": "var(--dim)",
    "#999999": "var(--dim)",
    "#eeeeee": "var(--line)",
}
"""Colours of the picture -> what they become on a page that is light or dark."""


def draw_curve(scores: Scores, file: "str | Path | IO[bytes]", form: str = "png") -> None:
    """Draws the ordered curve: partners in ascending order of their mean, one curve per layout.

    With two training seeds or more a band shows each point's own 95 % interval.

    Args:
        scores: What to draw.
        file: Where to.
        form: "png" or "svg".
    """
    import matplotlib
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    with matplotlib.rc_context(_STYLE):
        figure = Figure(figsize=(8, 4.8), dpi=120, layout="constrained")
        FigureCanvasAgg(figure)
        axes = figure.subplots()
        for index, layout in enumerate(scores.layouts):
            _draw_layout(axes, scores, layout, COLOURS[index % len(COLOURS)], _MARKERS[index % len(_MARKERS)])
        _dress(axes, scores)
        metadata: dict[str, Any] = {"Software": None} if form == "png" else {"Date": None, "Creator": None}
        figure.savefig(file, format=form, metadata=metadata, transparent=form == "svg")


def follow_theme(svg: str) -> str:
    """Returns a picture as an element of a page, in the page's colours of text and lines, without a background."""
    element = svg[svg.index("<svg") :]
    return re.sub(r"#[0-9a-f]{6}\b", lambda colour: _BY_THEME.get(colour[0], colour[0]), element)


def _draw_layout(axes: "Axes", scores: Scores, layout: LayoutFacts, colour: str, marker: str) -> None:
    means = sorted(scores.select("curve", layout=layout.layout), key=lambda row: row.params["rank"])
    share = [100 * row.params["rank"] / len(means) for row in means]
    values = [row.value for row in means]
    axes.plot(share, values, color=colour, marker=marker, markersize=5, clip_on=False, label=layout.layout)
    if all(mean.low is not None and mean.high is not None for mean in means):
        low, high = [mean.low or 0.0 for mean in means], [mean.high or 0.0 for mean in means]
        axes.fill_between(share, low, high, color=colour, alpha=0.15, linewidth=0)


def _dress(axes: "Axes", scores: Scores) -> None:
    worth = sorted({layout.soup_points for layout in scores.layouts})
    for points, soups in product(worth or [DEFAULT_SOUP_REWARD], scores.settings.report.thresholds):
        axes.axhline(points * soups, color="#999999", linewidth=0.8, linestyle=":")
        label = f"{soups:g} soup" + "s" * (soups != 1) + f" of {points:g}" * (len(worth) > 1)
        axes.annotate(
            *(label, (1.005, points * soups)),
            xycoords=("axes fraction", "data"),
            va="center",
            fontsize=8,
            color="#666666",
        )
    axes.set_xlim(0, 102)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("share of the partners, worst first (%)", color=_INK)
    axes.set_ylabel("points per episode", color=_INK)
    bands = f"; bands: pointwise 95 % over {scores.training_seeds} training seeds" if scores.training_seeds > 1 else ""
    pool = scores.pool.name if scores.pool else "no pool"
    title = f"{scores.agent.name}: ordered curve, protocol {scores.protocol.name}, pool {pool}{bands}"
    axes.set_title(title, fontsize=10, loc="left", color=_INK)
    axes.spines[["top", "right"]].set_visible(False)
    axes.grid(axis="y", color="#eeeeee", linewidth=0.6)
    axes.set_axisbelow(True)
    if scores.layouts:
        axes.legend(frameon=False, fontsize=9)
