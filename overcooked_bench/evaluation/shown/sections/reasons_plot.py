"""The shares of moments with each reason, as bars."""

from functools import partial
from typing import TYPE_CHECKING, Final

from overcooked_bench.evaluation.explaining.reasons import REASONS, Reason
from overcooked_bench.evaluation.explaining.records import Explanation, Shares
from overcooked_bench.evaluation.shown.figures import COLOURS, Plot, short_name

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_COLOURS: Final[dict[Reason, str]] = {
    "clash": COLOURS[1],
    "inexperience": COLOURS[0],
    "weak partner": COLOURS[3],
    "neither": COLOURS[5],
    "works": "#b5bcc2",
}


def reasons_plot(found: Explanation) -> Plot:
    """Returns one bar per layout and one for all of them, divided by the reasons."""
    bars = [(one.layout, one.shares) for one in found.layouts] + [("all layouts", found.total)]
    bars = [(name, shares) for name, shares in bars if shares.reasons]
    said = "; ".join(
        f"{name}: " + ", ".join(f"{reason} {100 * shares.reasons[reason].value:.0f} %" for reason in _COLOURS)
        for name, shares in bars
    )
    return Plot(partial(_paint, bars=bars), (4.6, 0.3 * len(bars) + 1.25), f"Shares of moments. {said}")


def _paint(figure: "Figure", bars: list[tuple[str, Shares]]) -> None:
    axes = figure.subplots()
    left = [0.0] * len(bars)
    for reason, colour in _COLOURS.items():
        widths = [100 * shares.reasons[reason].value for _, shares in bars]
        label = REASONS[reason].heading.replace("\n", " ")
        axes.barh(range(len(bars)), widths, 0.7, left, color=colour, label=label)
        left = [start + width for start, width in zip(left, widths, strict=True)]
    axes.set_yticks(range(len(bars)), [short_name(name) for name, _ in bars])
    axes.set_ylim(len(bars) - 0.5, -0.5)
    axes.set_xlim(0, 100)
    axes.set_xlabel("moments (%)")
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    figure.legend(loc="outside upper left", ncols=2, fontsize=9, handlelength=1)
