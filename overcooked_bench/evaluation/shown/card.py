"""A score under a protocol with headlines as one table, with a reference agent below it."""

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

from overcooked_bench.evaluation.beside import Beside
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import MEAN, Row, Scores
from overcooked_bench.evaluation.shown.tables import NONE, figure, layout_name
from overcooked_bench.rendering.table import Cell, Column, Number, Table

WORST: Final = "worst_third"
_OVERALL: Final = "mean of layouts"
STRATA: Final = {
    "own": "own: trained with the pool's own code",
    "other-trainers": "other-trainers (other code): trained with other people's code",
    "human": "human: clones of people",
    "scripted": "scripted (scripts): agents of rules",
}
"""Strata of partners in the order in which they are shown, and what they are."""
HEADS: Final = {"other-trainers": "other\ncode", "scripted": "scripts"}
"""Headings of columns of strata that are not their names."""
_GAP: Final = 2

_Cells = Callable[[Scores, str | None], Cell]


class _Shown(NamedTuple):
    """A column: its heading, its cell for a score on a layout or over all, and how soon it is left out for space."""

    heading: str
    cell: _Cells
    spare: int = 0


def card_table(scores: Scores, shown_beside: Beside, width: int) -> Table:
    """Lays out one row per layout and the mean over all of them; below it, or per layout, the reference agent.

    Args:
        scores: What to show.
        shown_beside: The reference, and the score with the criterion's pool, where there are such.
        width: Characters of a line; columns that can be spared make room.
    """
    columns = _columns(scores, shown_beside)
    while _width(table := _table(scores, shown_beside.reference, columns)) > width:
        spare = max(columns, key=lambda column: column.spare)
        if not spare.spare:
            break
        columns = [column for column in columns if column is not spare]
    return table


def columns_note(scores: Scores) -> str:
    """Says what the columns besides the headlines are."""
    first, *_ = scores.settings.report.headlines
    title = next((facts.label.partition(" ")[0] for facts in scores.metrics if facts.name == first), first)
    rows = list(scores.select(first))
    strata = [HEADS.get(one, one).replace("\n", " ") for one in STRATA if any(row.stratum == one for row in rows)]
    said = [f"{', '.join(strata)}: {title} with each stratum of partners"] if strata else []
    if not scores.settings.report.ranked:
        said.insert(0, f"{title} ± s.e.: the score and its standard error")
    if any(row.home is False for row in rows):
        said.append(f"away: {title} with partners of other code and other people than the agent was trained with")
    if any(scores.select(WORST)):
        said.append(f"worst third: mean {title} of that third of the partners")
    said.append("points: mean return per episode")
    return f"Columns: {'; '.join(said)}."


def _columns(scores: Scores, shown_beside: Beside) -> list[_Shown]:
    first, *others = scores.settings.report.headlines
    whole = {"partner": None, "stratum": None, "home": None}
    known = {facts.name: facts for facts in scores.metrics if any(scores.select(facts.name, **whole))}
    columns = [_Shown(known[first].label, _headline(first, scores.settings.report.ranked))] if first in known else []
    if columns and not scores.settings.report.ranked:
        columns = [_Shown(f"{known[first].label.partition(' ')[0]} ± s.e.", columns[0].cell)]
    columns += [_Shown(known[name].label, _value(name)) for name in others if name in known]
    strata = dict.fromkeys(row.stratum for row in scores.select(first) if row.stratum is not None)
    columns += [_Shown(HEADS.get(one, one), _value(first, stratum=one)) for one in sorted(strata, key=_order)]
    if any(row.home is False for row in scores.select(first)):
        columns.append(_Shown("away", _value(first, home=False), 2))
    columns += [_Shown(known[WORST].label, _value(WORST), 3)] if WORST in known else []
    columns += [_Shown("points", _value(MEAN), 1)] if MEAN in known else []
    criterion = shown_beside.criterion
    if criterion is not None and criterion.pool is not None:
        columns.append(_Shown(criterion.pool.name.replace("-", "-\n"), _other(criterion, scores)))
    return columns


def _order(stratum: str) -> tuple[int, str]:
    known = [*STRATA]
    return known.index(stratum) if stratum in known else len(known), stratum


def _table(scores: Scores, reference: Scores | None, columns: Sequence[_Shown]) -> Table:
    def cells(of: Scores, layout: str | None) -> list[Cell]:
        return [column.cell(of, layout) for column in columns]

    rows: list[list[Cell]] = []
    ranking = scores.find(scores.headline) or scores.find(MEAN)
    whole = scores.overall is not None or (ranking is not None and ranking.metric != scores.headline)
    for layout in scores.layouts:
        rows.append([layout_name(layout), *cells(scores, layout.layout)])
        if reference is not None and not whole:
            rows.append([f"  {reference.agent.name}", *cells(reference, layout.layout)])
    rows += [[declined.layout, "declined"] for declined in scores.declined]
    foot: list[list[Cell]] = [[_OVERALL, "none"]]
    if whole:
        foot = [[_OVERALL, *cells(scores, None)]]
        foot += [[reference.agent.name, *cells(reference, None)]] if reference is not None else []
    heads = [Column(column.heading, wrap=False) for column in columns]
    return Table(["layout", *(heads or [Column("")])], rows, foot)


def _width(table: Table) -> int:
    """Returns how many characters wide a table is in a terminal."""
    columns = [column if isinstance(column, str) else column.heading for column in table.columns]
    cells = [columns, *([*map(str, row)] for row in (*table.rows, *table.foot))]
    widths = [
        max(len(line) for row in cells if index < len(row) for line in row[index].split("\n"))
        for index in range(len(columns))
    ]
    return sum(widths) + _GAP * (len(widths) - 1)


def _headline(metric: str, ranked: bool) -> _Cells:
    def cell(of: Scores, layout: str | None) -> Cell:
        row, facts = of.find(metric, layout=layout), _facts(of, metric)
        if row is None or facts is None:
            return NONE
        if ranked:
            return figure(row.estimate, facts, True)
        error = "" if row.error is None else f"± {row.error:.{facts.digits}f}"
        return Number(figure(row.estimate, facts, False).value, error)

    return cell


def _value(metric: str, **about: object) -> _Cells:
    def cell(of: Scores, layout: str | None) -> Cell:
        return _plain(of, of.find(metric, layout=layout, **about), metric)

    return cell


def _other(criterion: Scores, scores: Scores) -> _Cells:
    """Shows the mean return of the same agent under another protocol; nothing for a reference agent."""

    def cell(of: Scores, layout: str | None) -> Cell:
        return _plain(criterion, criterion.find(MEAN, layout=layout), MEAN) if of is scores else ""

    return cell


def _plain(of: Scores, row: Row | None, metric: str) -> Cell:
    facts = _facts(of, metric)
    return NONE if row is None or facts is None else figure(row.estimate, facts, False)


def _facts(of: Scores, metric: str) -> MetricFacts | None:
    return next((facts for facts in of.metrics if facts.name == metric), None)
