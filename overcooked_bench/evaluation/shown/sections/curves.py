"""The ordered curves: the mean return with the worst partner, the second worst, and so on, one panel per layout."""

from collections.abc import Sequence
from functools import partial
from html import escape
from typing import TYPE_CHECKING

from overcooked_bench.evaluation.scores import LayoutFacts, Row, Scores
from overcooked_bench.evaluation.shown.figures import DIM, LINE, Plot, short_name
from overcooked_bench.evaluation.shown.sections.section import Entrant, Material, Section, legend
from overcooked_bench.rendering.page import note

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PANEL = (3.3, 2.5)
_COLUMNS = 3


def curves_section(material: Material) -> Section | None:
    """Draws the ordered curve of each layout beside the chosen scores and the reference; None if the score has none."""
    entrants = material.entrants
    layouts = [layout for layout in material.scores.layouts if _curve(material.scores, layout.layout)]
    if not layouts:
        return None
    panels = [_panel_plot(entrants, layout).element() for layout in layouts]
    said = "Partners in ascending order of their mean, sorted separately for each training seed. "
    if any(one.scores.training_seeds > 1 for one in entrants if not one.reference):
        said += "Bands: pointwise 95 % over training seeds; dotted: their 0.15-quantile. "
    said += "An agent of one training run has no band. Horizontal lines: numbers of soups."
    figures = "".join(
        f"<div><h3>{escape(layout.layout)}</h3>{panel}</div>" for layout, panel in zip(layouts, panels, strict=True)
    )
    parts = [legend(entrants), f'<div class="panels">{figures}</div>', note(said)]
    return Section("Ordered curves", parts, plots={"curves": curves_plot(entrants, layouts)})


def curves_plot(entrants: Sequence[Entrant], layouts: Sequence[LayoutFacts]) -> Plot:
    """Returns all panels in one plot."""
    columns = min(_COLUMNS, len(layouts))
    rows = -(-len(layouts) // columns)
    size = (_PANEL[0] * columns, _PANEL[1] * rows + 0.4)
    return Plot(partial(_paint_all, entrants=entrants, layouts=layouts), size, "ordered curves")


def _panel_plot(entrants: Sequence[Entrant], layout: LayoutFacts) -> Plot:
    def paint(figure: "Figure") -> None:
        _panel(figure.subplots(), entrants, layout)

    means = [(one.name, _curve(one.scores, layout.layout)) for one in entrants]
    said = "; ".join(
        f"{name} from {rows[0].value:.0f} with the worst partner to {rows[-1].value:.0f} with the best"
        for name, rows in means
        if rows
    )
    return Plot(paint, _PANEL, f"Points per episode on {layout.layout}: {said}")


def _paint_all(figure: "Figure", entrants: Sequence[Entrant], layouts: Sequence[LayoutFacts]) -> None:
    columns = min(_COLUMNS, len(layouts))
    grid = figure.subplots(-(-len(layouts) // columns), columns, squeeze=False).ravel()
    for axes in grid[len(layouts) :]:
        axes.set_axis_off()
    for axes, layout in zip(grid, layouts, strict=False):
        _panel(axes, entrants, layout)
        axes.set_title(short_name(layout.layout), fontsize=9, loc="left")
    lines, names = grid[0].get_legend_handles_labels()
    figure.legend(lines[::-1], names[::-1], loc="outside upper left", ncols=4, fontsize=9)


def _panel(axes: "Axes", entrants: Sequence[Entrant], layout: LayoutFacts) -> None:
    for one in reversed(entrants):
        _line(axes, one, layout.layout)
    axes.set_xlim(0, 102)
    axes.set_xlabel("share of partners, worst first (%)")
    axes.set_ylabel("points per episode")
    axes.grid(axis="y")
    _thresholds(axes, [layout.soup_points * soups for soups in entrants[0].scores.settings.report.thresholds], layout)


def _thresholds(axes: "Axes", levels: Sequence[float], layout: LayoutFacts) -> None:
    """Draws lines at those numbers of soups that are within sight, and writes the numbers where there is room."""
    top, free = max(axes.get_ylim()[1], 1.05 * min(levels, default=0.0)), 0.0
    axes.set_ylim(0, top)
    for level in sorted(level for level in levels if level <= top):
        axes.axhline(level, color=LINE, linewidth=0.7, linestyle=(0, (1, 2)))
        if level >= free:
            where, text = (1.01, level), f"{level / layout.soup_points:g}"
            axes.annotate(text, where, xycoords=("axes fraction", "data"), va="center", fontsize=7, color=DIM)
            free = level + 0.07 * top


def _line(axes: "Axes", one: Entrant, layout: str) -> None:
    rows = _curve(one.scores, layout)
    if not rows:
        return
    shares = [100 * row.params["rank"] / len(rows) for row in rows]
    values = [row.value for row in rows]
    if one.reference:
        axes.plot(shares, values, label=one.name, color=DIM, linestyle="--", linewidth=1.2)
        return
    axes.plot(shares, values, label=one.name, color=one.colour, linewidth=1.8)
    low, high = ([end for row in rows if (end := getattr(row, side)) is not None] for side in ("low", "high"))
    if len(low) < len(rows):
        return
    axes.fill_between(shares, low, high, color=one.colour, alpha=0.18, linewidth=0)
    quantiles = _curve(one.scores, layout, "curve_quantile")
    if len(quantiles) == len(rows):
        axes.plot(shares, [row.value for row in quantiles], color=one.colour, linestyle=":", linewidth=1.2)


def _curve(scores: Scores, layout: str, metric: str = "curve") -> list[Row]:
    return sorted(scores.select(metric, layout=layout), key=lambda row: row.params["rank"])
