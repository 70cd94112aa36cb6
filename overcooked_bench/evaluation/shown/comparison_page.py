"""A comparison of scores as one HTML page without external files: tables and forest plots."""

from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Final

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.comparing.compare import Compared, Comparison
from overcooked_bench.evaluation.comparing.differences import Difference
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.shown.comparison import (
    ALL_LAYOUTS,
    comparison_notes,
    metric_tables,
    partners_table,
    primary,
    strata_table,
    title_of,
    whole,
)
from overcooked_bench.evaluation.shown.forest import STYLE, Bar, forest
from overcooked_bench.evaluation.shown.tables import figure
from overcooked_bench.files import write_whole
from overcooked_bench.rendering.page import definitions, note, page, section

COMPARISON_FILE: Final = "comparison.html"

_LONGEST: Final = 22
"""Characters of a name above a plot."""
_LONGEST_OF_TWO: Final = 16
"""And of each of two names in a row of it."""


def write_comparison(found: Comparison, file: str | Path) -> None:
    """Writes the page.

    Args:
        found: What to show.
        file: Where to.
    """
    names = [one.name for one in found.entrants]
    title = " and ".join(names) if len(names) == 2 else f"{', '.join(names[:-1])} and {names[-1]}"
    body = [
        f"<h1>{escape(title)}</h1>",
        note(_subtitle(found), "sub"),
        *(part for compared in found.metrics for part in _metric(found, compared)),
        *section("How to read it", *map(note, comparison_notes(found))),
        *section("What was compared", definitions(_facts(found))),
    ]
    write_whole(Path(file), page(f"{title}: overcooked-bench compare", body, STYLE))


def _subtitle(found: Comparison) -> str:
    pool = f", pool {found.pool.name}" if found.pool else ""
    seeds = found.entrants[0].training_seeds
    runs = f"methods, {seeds} training seeds of each" if found.kind == "methods" else "agents, one artefact each"
    return f"protocol {found.protocol.name}{pool}, {runs}"


def _metric(found: Comparison, compared: Compared) -> list[str]:
    """Returns the parts of one metric."""
    parts = [table.html() for table in metric_tables(found, compared)]
    bars = list(_bars(found, compared))
    if bars:
        two = len(compared.pairs) == 1
        left, right = (_short(one.name) for one in found.entrants[1::-1]) if two else ("second", "first")
        parts.insert(0, forest(bars, f"{left} better", f"{right} better"))
    return section(title_of(compared.metric), *parts, *_details(found, compared))


def _bars(found: Comparison, compared: Compared) -> Iterator[Bar]:
    """Yields what is drawn: of two scores all layouts and strata, of more every pair over all layouts."""
    facts = compared.metric
    if len(compared.pairs) > 1:
        for pair in compared.pairs:
            names = " − ".join(
                _short(found.entrants[index].name, _LONGEST_OF_TWO) for index in (pair.first, pair.second)
            )
            for one in primary(pair):
                yield _bar(facts, one, f"{names}{', ' + one.layout if one.layout else ''}")
        return
    (pair,) = compared.pairs
    for one in whole(pair):
        yield _bar(facts, one, one.layout or ALL_LAYOUTS, strong=one.layout is None)
    for one in pair.differences:
        if one.stratum and one.layout is None:
            yield _bar(facts, one, f"with {one.stratum}")


def _bar(facts: MetricFacts, one: Difference, label: str, strong: bool = False) -> Bar:
    factor = 100 if facts.unit == "share" else 1
    scaled = Estimate(*(None if end is None else end * factor for end in one.difference))  # type: ignore[arg-type]
    of = f"{facts.heading(one.params)} " if one.params else ""
    return Bar(of + label, scaled, str(figure(one.difference, facts, True)), strong)


def _details(found: Comparison, compared: Compared) -> Iterator[str]:
    """Yields strata, and partners layout by layout, folded up."""
    for pair in compared.pairs:
        names = " − ".join(found.entrants[index].name for index in (pair.first, pair.second))
        layouts = dict.fromkeys(one.layout for one in pair.differences if one.partner and one.layout)
        tables = [("strata of partners", strata_table(found, compared, pair))]
        tables += [(f"partners on {layout}", partners_table(found, compared, pair, layout)) for layout in layouts]
        for about, table in tables:
            if table is not None:
                yield f"<details><summary>{escape(f'{names}: {about}')}</summary>{table.html()}</details>"


def _facts(found: Comparison) -> Iterator[tuple[str, str]]:
    for one in found.entrants:
        yield one.name, f"SHA-256 {one.sha256}"
    yield "protocol", f"{found.protocol.name}, SHA-256 {found.protocol.sha256}"
    yield "pool", f"{found.pool.name}, SHA-256 {found.pool.sha256}" if found.pool else "none"


def _short(name: str, most: int = _LONGEST) -> str:
    return name if len(name) <= most else name[: most - 1] + "…"
