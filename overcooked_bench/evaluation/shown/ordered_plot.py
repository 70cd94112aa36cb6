"""Ordered curves of cross-play as a picture, as the thesis draws them."""

from functools import partial
from pathlib import Path
from typing import IO, TYPE_CHECKING

from overcooked_bench.evaluation.ordered.curves import SHARES
from overcooked_bench.evaluation.ordered.table import Figure
from overcooked_bench.evaluation.protocol import OrderedReport
from overcooked_bench.evaluation.shown.figures import COLOURS, Plot

if TYPE_CHECKING:
    from matplotlib.figure import Figure as Picture


def draw_ordered(figure: Figure, rule: OrderedReport, file: "str | Path | IO[bytes]", form: str = "png") -> None:
    """Draws the mean over rows with its band, and beside it the low quantile with its own.

    Args:
        figure: What to draw.
        rule: Says which quantiles the bands are.
        file: Where to.
        form: "png" or "svg".
    """
    Plot(partial(_paint, figure=figure, rule=rule), (10, 4.8), f"ordered curves on {figure.layout}").save(file, form)


def _paint(picture: "Picture", figure: Figure, rule: OrderedReport) -> None:
    share = [100 * x for x in SHARES]
    least = ", ".join("minimum" if not quantile else f"{quantile:g}" for quantile in rule.quantile_band)
    titles = f"mean ({rule.band[0]:g}, {rule.band[1]:g} quantiles)", f"{rule.quantile:g} quantile ({least})"
    panels = picture.subplots(1, 2, sharey=True)
    for index, one in enumerate(figure.curves):
        colour = COLOURS[index % len(COLOURS)]
        style = "-" if index < len(COLOURS) else "--"
        for panel, middle, band in zip(panels, (one.mean, one.quantile), (one.band, one.quantile_band), strict=True):
            panel.step(share, middle, style, color=colour, where="pre", label=f"{one.entrant} ({len(one.rows)})")
            panel.fill_between(share, *band, color=colour, alpha=0.12, linewidth=0, step="pre")
    for panel, title in zip(panels, titles, strict=True):
        panel.set_title(title, fontsize=9, loc="left")
        panel.set_xlabel("share of the partners, worst first (%)")
        panel.set_xlim(0, 100)
        panel.set_ylim(bottom=0)
        panel.grid(axis="y")
    panels[0].set_ylabel("points per episode")
    handles, names = panels[0].get_legend_handles_labels()
    picture.legend(handles, names, loc="outside lower center", ncols=3, fontsize=8)
    agents = "self-play agents" if figure.partners == "self-play" else figure.partners
    title = f"{figure.layout}: ordered cross-play with {agents}; number of rows in brackets"
    picture.suptitle(title, fontsize=9, x=0.01, ha="left")
