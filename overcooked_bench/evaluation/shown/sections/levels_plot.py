"""A metric over all layouts and on each, with intervals, as dots; the reference as a line across."""

from functools import partial
from typing import TYPE_CHECKING

from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import Row, Scores
from overcooked_bench.evaluation.shown.comparison import ALL_LAYOUTS, title_of
from overcooked_bench.evaluation.shown.figures import DIM, Plot, short_name
from overcooked_bench.evaluation.shown.sections.section import Entrant, Material
from overcooked_bench.evaluation.shown.tables import figure

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


def levels_plot(material: Material, facts: MetricFacts, legend: bool = False) -> Plot:
    """Returns the plot of a metric; its first row is the mean over layouts, if all of them were played.

    Args:
        material: What to show.
        facts: The metric.
        legend: Whether the plot says which marks are whose, as it has to in a file of its own.
    """
    rows = len(material.entrants) if legend and len(material.entrants) > 1 else 0
    return Plot(
        partial(_paint, material=material, facts=facts, legend=rows > 0),
        (4.6, 0.3 * len(_names(material.scores)) + 0.6 + 0.18 * rows),
        _said(material, facts),
    )


def _names(scores: Scores) -> list[str]:
    return [ALL_LAYOUTS] * (scores.overall is not None) + [layout.layout for layout in scores.layouts]


def _found(one: Scores, about: Scores, facts: MetricFacts) -> list[Row | None]:
    """Returns the metric of a score for all layouts, if that is known, and for each of them."""
    whole = [one.find(facts.name)] if about.overall is not None else []
    return [*whole, *(one.find(facts.name, layout=layout.layout) for layout in about.layouts)]


def _said(material: Material, facts: MetricFacts) -> str:
    names, parts = _names(material.scores), []
    for one in material.entrants:
        rows = zip(names, _found(one.scores, material.scores, facts), strict=True)
        parts.append(
            f"{one.name}: " + ", ".join(f"{name} {figure(row.estimate, facts, False)}" for name, row in rows if row)
        )
    return f"{title_of(facts)} of " + "; ".join(parts)


def _paint(painted: "Figure", material: Material, facts: MetricFacts, legend: bool) -> None:
    scores, axes = material.scores, painted.subplots()
    names = _names(scores)
    scored = [one for one in material.entrants if not one.reference]
    for one in material.entrants:
        for place, row in enumerate(_found(one.scores, scores, facts)):
            if row is not None:
                _mark(axes, one, place + _offset(one, scored), row, facts)
    axes.set_yticks(range(len(names)), [*map(short_name, names)])
    axes.set_ylim(len(names) - 0.5, -0.5)
    axes.axvline(0, color=DIM, linewidth=0.8)
    axes.set_xlabel(title_of(facts) + (f" ({'%' if facts.unit == 'share' else facts.unit})" if facts.unit else ""))
    axes.grid(axis="x")
    axes.spines["left"].set_visible(False)
    axes.tick_params(axis="y", length=0)
    if legend:
        named = dict(zip(*axes.get_legend_handles_labels()[::-1], strict=True))  # each once
        painted.legend([*named.values()], [*named], loc="outside upper left", fontsize=9)


def _offset(one: Entrant, scored: list[Entrant]) -> float:
    """Returns how far below its row's middle an agent is drawn: several are one below the other."""
    if one.reference or len(scored) == 1:
        return 0.0
    return 0.5 * (scored.index(one) / (len(scored) - 1) - 0.5)


def _mark(axes: "Axes", one: Entrant, y: float, row: Row, facts: MetricFacts) -> None:
    factor = 100 if facts.unit == "share" else 1
    value = factor * row.value
    if one.reference:
        axes.plot([value, value], [y - 0.36, y + 0.36], color=DIM, linewidth=2, label=one.name)
        return
    if row.estimate.interval:
        low, high = (factor * end for end in row.estimate.interval)
        axes.hlines(y, low, high, color=one.colour, linewidth=2.5, alpha=0.6)
    axes.plot(value, y, marker="o", linestyle="", color=one.colour, markersize=5, label=one.name)
