"""A comparison of scores as tables and notes, which terminal and page share."""

from collections.abc import Iterable, Iterator
from typing import TYPE_CHECKING, Final

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.comparing.compare import Compared, Comparison, Pair
from overcooked_bench.evaluation.comparing.differences import Difference
from overcooked_bench.evaluation.comparing.seeing import Sight
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.shown.tables import NONE, figure
from overcooked_bench.rendering.table import Cell, Column, Table, styled

if TYPE_CHECKING:
    from rich.console import Group, RenderableType

ALL_LAYOUTS: Final = "mean of layouts"


def comparison_tables(found: Comparison) -> "Group":
    """Lays a comparison out for the terminal: for each metric the differences, then what the numbers mean."""
    from rich.console import Group

    names = " · ".join(one.name for one in found.entrants)
    runs = f"{found.entrants[0].training_seeds} training seeds of each" if found.kind == "methods" else "one run each"
    head = f"{names} · protocol {found.protocol.name} ({found.protocol.sha256[:8]}) · {runs}"
    parts: list[RenderableType] = [styled(head, style="bold"), styled("")]
    for compared in found.metrics:
        for table in metric_tables(found, compared):
            parts += [table.terminal(), styled("")]
    parts += [styled(note, style="dim") for note in comparison_notes(found)]
    return Group(*parts)


def metric_tables(found: Comparison, compared: Compared) -> Iterator[Table]:
    """Yields the tables of one metric: of two scores layouts and differences in one, of more one of each."""
    if len(compared.pairs) == 1:
        yield _one_pair(found, compared, compared.pairs[0])
        return
    yield _levels(found, compared)
    yield _pairs(found, compared)


def strata_table(found: Comparison, compared: Compared, pair: Pair) -> Table | None:
    """Lays out one row per stratum of partners, over all layouts; None if there are no strata."""
    rows = [one for one in pair.differences if one.stratum and one.layout is None and _of_all_seats(one)]
    return _differences(found, compared, pair, "stratum", ((one.stratum or "", one) for one in rows)) if rows else None


def partners_table(found: Comparison, compared: Compared, pair: Pair, layout: str) -> Table | None:
    """Lays out one row per partner of a layout, the one that favours the first score most above; None without them."""
    rows = [one for one in pair.differences if one.partner and one.layout == layout and _of_all_seats(one)]
    rows.sort(key=lambda one: (-one.difference.value, one.partner))
    return _differences(found, compared, pair, "partner", ((one.partner or "", one) for one in rows)) if rows else None


def whole(pair: Pair) -> list[Difference]:
    """Returns the differences that are about all partners, seats and sides: over all layouts, then on each."""
    return [one for one in pair.differences if one.stratum is None and one.partner is None and _of_all_seats(one)]


def primary(pair: Pair) -> list[Difference]:
    """Returns the differences over all layouts, or on each if not all of them were played."""
    rows = whole(pair)
    return [one for one in rows if one.layout is None] or rows


def comparison_notes(found: Comparison) -> list[str]:
    """Returns notes on what the tables do not show."""
    said = [found.interval, *filter(None, [found.test])]
    said += [compared.metric.note for compared in found.metrics if compared.metric.note]
    said += [text for compared in found.metrics if (text := _seen(compared, found.entrants[0].training_seeds))]
    again = [one.name for one in found.entrants if one.computed_again]
    if again:
        said.append(f"Computed again from its episodes, as the first score is reported: {', '.join(again)}.")
    return said


def title_of(facts: MetricFacts) -> str:
    """Returns what a metric is called without its parameters and its interval."""
    title = facts.label.partition("{")[0].partition("[")[0].replace("\n", " ").strip()
    return title if any(map(str.isalnum, title)) else facts.name


def p_text(p: float | None) -> str:
    """Writes a p."""
    return NONE if p is None else "<0.001" if p < 0.001 else f"{p:.3f}"


def _of_all_seats(one: Difference) -> bool:
    return one.seat is None and one.side is None


def _one_pair(found: Comparison, compared: Compared, pair: Pair) -> Table:
    rows = whole(pair)
    layouts = ((one.layout, one) for one in rows if one.layout)
    foot = ((ALL_LAYOUTS, one) for one in rows if not one.layout)
    return _differences(found, compared, pair, "layout", layouts, foot)


def _differences(
    found: Comparison,
    compared: Compared,
    pair: Pair,
    about: str,
    rows: Iterable[tuple[str, Difference]],
    foot: Iterable[tuple[str, Difference]] = (),
) -> Table:
    """Lays out differences of one pair.

    Args:
        found: The comparison.
        compared: The metric.
        pair: The pair.
        about: Heading of the first column.
        rows: What is in the first column, and the difference.
        foot: The same, below a line.
    """
    facts, names = compared.metric, (found.entrants[pair.first].name, found.entrants[pair.second].name)
    listed, below = list(rows), list(foot)
    many = any(one.params for _, one in (*listed, *below))
    tested = any(one.p is not None for _, one in (*listed, *below))

    def cells(name: str, one: Difference) -> list[Cell]:
        start: list[Cell] = [name, *[facts.heading(one.params)] * many]
        values = [figure(Estimate(value), facts) for value in (one.first, one.second)]
        return [*start, *values, figure(one.difference, facts, True), *_tests(one) * tested]

    title = title_of(facts)
    heads = [Column("of", wrap=False)] * many + [Column(f"{title}\n{name}") for name in names]
    heads += [Column("difference [95 %]", wrap=False)]
    heads += [Column("better", wrap=False), Column("p", wrap=False)] * tested
    return Table(
        [Column(about, left=True, wrap=False), *heads],
        [cells(*row) for row in listed],
        [cells(*row) for row in below],
    )


def _levels(found: Comparison, compared: Compared) -> Table:
    """Lays out one row per layout, and one column per score."""
    facts, values = compared.metric, dict[tuple[str | None, str], dict[int, float]]()
    for pair in compared.pairs:
        for one in whole(pair):
            known = values.setdefault((one.layout, facts.heading(one.params) if one.params else ""), {})
            known |= {pair.first: one.first, pair.second: one.second}
    count = range(len(found.entrants))

    def cells(layout: str | None, of: str) -> list[Cell]:
        known = values[layout, of]
        numbers = (figure(Estimate(known[i]), facts) if i in known else NONE for i in count)
        return [" ".join(filter(None, (layout or ALL_LAYOUTS, of))), *numbers]

    heads = [Column(one.name) for one in found.entrants]
    return Table(
        [Column(title_of(facts), left=True, wrap=False), *heads],
        [cells(*key) for key in values if key[0]],
        [cells(*key) for key in values if not key[0]],
    )


def _pairs(found: Comparison, compared: Compared) -> Table:
    """Lays out one row per pair of scores."""
    facts, rows = compared.metric, list[list[Cell]]()
    for pair in compared.pairs:
        for one in primary(pair):
            where = " ".join(filter(None, (one.layout or "", facts.heading(one.params) if one.params else "")))
            names = [found.entrants[index].name for index in (pair.first, pair.second)]
            tests = [*_tests(one), p_text(one.adjusted)]
            rows.append([*names, where, figure(one.difference, facts, True), *tests])
    title = title_of(facts)
    wide = ("", f"{title}: difference [95 %]", "better", "p", "Holm")
    heads = [Column("first", left=True), Column("second", left=True), *(Column(head, wrap=False) for head in wide)]
    return Table(heads, rows)


def _tests(one: Difference) -> list[Cell]:
    return [NONE if one.better is None else f"{100 * one.better:.0f} %", p_text(one.p)]


def _seen(compared: Compared, seeds: int) -> str:
    """Says what the training seeds of methods let one see."""
    facts, layouts = compared.metric, [one for one in compared.sights if one.layout]
    if not compared.sights:
        return ""

    def plain(value: float) -> str:
        return figure(Estimate(value), facts).value

    parts = [f"±{plain(one.seen)} for the mean of layouts" for one in compared.sights if not one.layout]
    if layouts:
        least, most = min(layouts, key=_width), max(layouts, key=_width)
        ends = " to ".join(dict.fromkeys(f"±{plain(one.seen)}" for one in (least, most)))
        needed = " to ".join(dict.fromkeys(str(one.needed or "over 1,000") for one in (least, most)))
        parts.append(f"{ends} on one layout, where {plain(least.step)} would need {needed} of each")
    return f"What {seeds} training seeds buy, {title_of(facts)}: a difference has an interval of {'; '.join(parts)}."


def _width(one: Sight) -> float:
    return one.seen
