"""The pictures of the evidence page: cross-play, scores held against people's proxies, and predictors compared."""

from io import BytesIO
from itertools import groupby
from typing import TYPE_CHECKING, Any, Final

import numpy as np

from overcooked_bench.evaluation.shown.figures import COLOURS
from overcooked_bench.human.shown import name as short

from .records import Evidence, LayoutRecord
from .validity import HEADLINE, PEOPLE, PREDICTORS, SAME

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_INK: Final = "#333333"
_MARKS: Final = "osD^vPX"


def draw_cross_play(found: Evidence) -> bytes:
    """Draws a matrix per layout, strata divided by lines, as PNG."""
    count = len(found.layouts)
    columns = min(3, count)
    with _style():
        figure = _figure(max(6.0, 3.3 * columns), 3.3 * -(-count // columns))
        panels = figure.subplots(-(-count // columns), columns, squeeze=False).ravel()
        for axes in panels[count:]:
            axes.set_axis_off()
        for axes, layout in zip(panels, found.layouts, strict=False):
            means = np.array(layout.cross_play)
            image = axes.imshow(means, cmap="cividis", vmin=0, vmax=max(20.0, float(means.max())))
            figure.colorbar(image, ax=axes, shrink=0.75, pad=0.02)
            _divide(axes, layout)
            axes.set_title(short(layout.layout), fontsize=9, loc="left", color=_INK)
        figure.suptitle(
            "Points per episode; seat 0 downwards, seat 1 to the right; white lines divide the strata",
            fontsize=8, x=0.01, ha="left", color=_INK,
        )  # fmt: skip
        return _png(figure)


def draw_people(found: Evidence) -> bytes:
    """Draws each entrant's score without the human stratum against its mean with proxies of people, as PNG."""
    families = sorted({entrant.family for layout in found.layouts for entrant in layout.entrants})
    looks = {name: _look(index) for index, name in enumerate(families)}
    with _style():
        figure = _figure(max(7.0, 2.4 * len(found.layouts) + 0.4), 4.0)
        panels = figure.subplots(1, len(found.layouts), squeeze=False)[0]
        for axes, layout in zip(panels, found.layouts, strict=True):
            for entrant in layout.entrants:
                if HEADLINE in entrant.scores and PEOPLE in entrant.scores:
                    point = entrant.scores[HEADLINE], entrant.scores[PEOPLE]
                    colour, mark = looks[entrant.family]
                    axes.plot(*point, mark, color=colour, markersize=4, alpha=0.85, markeredgewidth=0)
            rho = next((one.rho for one in layout.correlations if (one.first, one.second) == (HEADLINE, PEOPLE)), None)
            said = f"\nSpearman {rho.text(2)}" if rho else ""
            axes.set_title(short(layout.layout) + said, fontsize=8, loc="left", color=_INK)
            axes.set_xlabel(HEADLINE)
            axes.set_ylim(bottom=0)
            axes.spines[["top", "right"]].set_visible(False)
        panels[0].set_ylabel("mean with human-test, points")
        handles = [panels[0].plot([], [], mark, color=colour, markersize=4)[0] for colour, mark in looks.values()]
        figure.legend(handles, list(looks), loc="outside lower center", ncols=4, fontsize=7, frameon=False)
        return _png(figure)


def draw_predictors(found: Evidence) -> bytes:
    """Draws the rank correlation of each predictor with the mean with proxies of people, as PNG."""
    panels_of = [(short(layout.layout), layout.correlations) for layout in found.layouts]
    if len(found.layouts) > 1:
        panels_of.append(("pooled", found.pooled))
    known = {one.first for _, all_ in panels_of for one in all_}
    names = [name for name in PREDICTORS if SAME + name in known]
    with _style():
        figure = _figure(1.75 * len(panels_of) + 1.9, 0.28 * len(names) + 1.0)
        panels = figure.subplots(1, len(panels_of), sharey=True, squeeze=False)[0]
        for axes, (title, all_) in zip(panels, panels_of, strict=True):
            by_name = {one.first: one.rho for one in all_}
            for y, name in enumerate(names):
                rho = by_name.get(SAME + name)
                colour = COLOURS[1] if name == HEADLINE else COLOURS[0]
                if rho is not None:
                    if rho.interval:
                        axes.plot(rho.interval, [y, y], color=colour, linewidth=1.4)
                    axes.plot(rho.value, y, "o", color=colour, markersize=4)
            axes.axvline(0, color="#aaaaaa", linewidth=0.8, zorder=0)
            axes.set_xlim(-1, 1)
            axes.set_xticks([-1, 0, 1])
            axes.set_title(title, fontsize=8, loc="left", color=_INK)
            axes.spines[["top", "right"]].set_visible(False)
        panels[0].set_yticks(range(len(names)), names)
        panels[0].invert_yaxis()
        return _png(figure)


def _divide(axes: "Axes", layout: LayoutRecord) -> None:
    """Divides the strata by lines and names them along both axes."""
    first, middles, names = 0, [], []
    for stratum, group in groupby(partner.stratum for partner in layout.partners):
        count = len(list(group))
        middles.append(first + (count - 1) / 2)
        names.append(stratum)
        first += count
        if first < len(layout.partners):
            axes.axhline(first - 0.5, color="white", linewidth=1.2)
            axes.axvline(first - 0.5, color="white", linewidth=1.2)
    axes.set_yticks(middles, names, rotation=90, va="center", fontsize=7)
    axes.set_xticks(middles, names, fontsize=7)
    axes.tick_params(length=0)


def _look(index: int) -> tuple[str, str]:
    return COLOURS[index % len(COLOURS)], _MARKS[(index + index // len(COLOURS)) % len(_MARKS)]


def _style() -> Any:
    import matplotlib

    return matplotlib.rc_context({"font.size": 8, "font.family": "DejaVu Sans"})


def _figure(width: float, height: float) -> "Figure":
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(width, height), dpi=110, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def _png(figure: "Figure") -> bytes:
    drawn = BytesIO()
    figure.savefig(drawn, format="png", metadata={"Software": None}, pil_kwargs={"optimize": True})
    return drawn.getvalue()
