"""A score as tables, for terminal and report."""

from collections.abc import Collection, Iterable
from typing import Literal

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.cells import PartnerLabel
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import MEAN, CategoryScore, LayoutFacts, ScenarioScore, Scores
from overcooked_bench.rendering.table import INTERVAL, Cell, Column, Number, Table

NONE = "-"
_BY_MEAN = (MEAN, "threshold")
"""What the mean return of a single partner says."""


def layouts_table(scores: Scores, place: Literal["terminal", "report"], without: Collection[str] = ()) -> Table:
    """Lays out one row per layout and one column per metric, with the mean over all layouts below.

    Args:
        scores: What to show.
        place: Where it is shown; metrics say whether they are a column there.
        without: Metrics that are shown elsewhere.
    """
    columns: list[tuple[str, str, dict[str, float], int | None]] = []
    for facts in scores.metrics:
        if place not in facts.tables or facts.name in without:
            continue
        found = _distinct(row.params for row in scores.select(facts.name, partner=None, stratum=None))
        for params in found or [{}] * (facts.name == MEAN):
            columns.append((facts.heading(params), facts.name, params, None))
            if facts.name == MEAN:
                columns += [(f"seat {seat}", MEAN, params, seat) for seat in scores.settings.play.seats]
    known = {facts.name: facts for facts in scores.metrics}

    def cells(layout: str | None) -> list[Cell]:
        found = ((scores.find(m, layout=layout, params=p, seat=seat), known[m], seat) for _, m, p, seat in columns)
        return [
            NONE if row is None else figure(row.estimate, facts, None if seat is None else False)
            for row, facts, seat in found
        ]

    rows: list[list[Cell]] = [[layout_name(layout), *cells(layout.layout)] for layout in scores.layouts]
    rows += [[declined.layout, "declined"] for declined in scores.declined]
    foot: list[list[Cell]] = []
    if scores.overall is None:
        foot = [["overall", "none"]]
    elif len(scores.layouts) > 1:
        foot = [["mean of layouts", *("" if cell == NONE else cell for cell in cells(None))]]
    heads = [Column(heading, wrap=metric == MEAN) for heading, metric, *_ in columns]
    return Table(["layout", *(heads or [Column("")])], rows, foot)


def partners_table(scores: Scores) -> Table:
    """Lays out one row per layout: the worst partner, the best one, and the floors."""
    floors = sorted({label.name for layout in scores.layouts for label in layout.partners if not label.counts})
    rows: list[list[Cell]] = []
    for layout in scores.layouts:
        pairs = scores.with_partners(layout)
        means = (scores.find(layout=layout.layout, partner=name) for name in floors)
        ends = [f"{name_of(label)} {row.value:.1f}" for label, row in (*pairs[:1], *pairs[-1:])] or [NONE, NONE]
        rows.append([layout_name(layout), *ends, *(f"{row.value:.1f}" if row else NONE for row in means)])
    return Table(["layout", "worst partner", "best partner", *(f"floor\n{name}" for name in floors)], rows)


def cells_table(scores: Scores, layout: LayoutFacts) -> Table:
    """Lays out one row per partner of a layout: mean return, by seat, and the metrics that are known for partners."""
    known = of_partners(scores, layout)
    others = [(facts, params) for facts, params in known if facts.name not in _BY_MEAN and facts.tables]
    seats = scores.settings.play.seats
    heads: list[str | Column] = ["partner", Column("kind", left=True), "mean [95 %]"]
    heads += [f"seat {seat}" for seat in seats]
    heads += [facts.heading(params).replace(INTERVAL, "") for facts, params in others]
    mean = next(facts for facts in scores.metrics if facts.name == MEAN)
    rows: list[list[Cell]] = []
    for label in partners_of(scores, layout):
        who = {"layout": layout.layout, "partner": label.name}
        own = scores.find(**who)
        by_seat = [scores.find(**who, seat=seat) for seat in seats]
        row: list[Cell] = [name_of(label), label.stratum if label.counts else label.kind]
        row += [NONE if own is None else figure(own.estimate, mean)]
        row += [NONE if one is None else figure(one.estimate, mean, False) for one in by_seat]
        for facts, params in others:
            one = scores.find(facts.name, **who, params=params)
            row.append(NONE if one is None else figure(one.estimate, facts, False))
        rows.append([*row, label.sha256[:12]])
    return Table([*heads, "SHA-256"], rows)


def scenarios_table(scenarios: ScenarioScore) -> Table:
    """Lays out what was passed by category."""

    def cells(one: CategoryScore) -> list[Cell]:
        missing = count_text(one.not_attempted) if one.not_attempted else NONE
        share = Number(f"{one.share.value:.2f}", one.share.text(2).partition(" ")[2]) if one.share else NONE
        return [one.category, count_text(one.passed), count_text(one.attempted), share, missing]

    heads = [scenarios.counted, "passed", "of", "share", "not attempted"]
    return Table(heads, [cells(one) for one in scenarios.categories], [cells(scenarios.total)])


def figure(estimate: Estimate, facts: MetricFacts, interval: bool | None = None) -> Number:
    """Writes a number of a metric as a cell.

    Args:
        estimate: The number.
        facts: The metric.
        interval: Whether its interval is wanted; by default the metric says so.
    """
    share = facts.unit == "share"
    scaled = [None if end is None else end * (100 if share else 1) for end in estimate]
    value, low, high = (NONE if end is None else _plain(end, facts.digits) for end in scaled)
    wanted = facts.interval if interval is None else interval
    ends = f"[{low}, {high}]" if wanted and estimate.interval else ""
    return Number(value + " %" * share, ends)


def _plain(number: float, digits: int) -> str:
    """Writes a number without the sign of a zero."""
    return f"{round(number, digits) + 0.0:.{digits}f}"


def name_of(label: PartnerLabel) -> str:
    """Returns a partner's name, with a star if it is the scored agent itself."""
    return label.name + "*" * label.is_ego


def count_text(count: float) -> str:
    """Writes a count, or a mean of counts: `12`, `12.5`."""
    return f"{count:.1f}".removesuffix(".0")


def layout_name(layout: LayoutFacts) -> str:
    """Returns a layout's name, and whether it was played by its mirror image."""
    return layout.layout + (" (adapted)" if layout.adapted else "")


def of_partners(scores: Scores, layout: LayoutFacts) -> list[tuple[MetricFacts, dict[str, float]]]:
    """Returns the metrics that are known for single partners of a layout, each with each set of its parameters."""
    return [
        (facts, params)
        for facts in scores.metrics
        for params in _distinct(
            row.params for row in scores.select(facts.name, layout=layout.layout, seat=None) if row.partner is not None
        )
    ]


def partners_of(scores: Scores, layout: LayoutFacts) -> list[PartnerLabel]:
    """Returns the partners of a layout: those that count, the worst first, then the floors."""
    counting = [label for label, _ in scores.with_partners(layout)]
    return [*counting, *(label for label in layout.partners if not label.counts)]


def _distinct(given: Iterable[dict[str, float]]) -> list[dict[str, float]]:
    """Keeps each set of parameters once, in the order of its first use."""
    return [dict(items) for items in dict.fromkeys(tuple(sorted(params.items())) for params in given)]
