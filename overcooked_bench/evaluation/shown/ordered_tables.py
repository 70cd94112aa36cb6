"""Ordered cross-play as tables: the thesis's table for the terminal, and every curve as CSV."""

from collections.abc import Sequence
from math import ceil, log
from typing import TYPE_CHECKING

from overcooked_bench.estimate import CONFIDENCE
from overcooked_bench.evaluation.ordered.curves import SHARES, THESIS_EFFECT, Line
from overcooked_bench.evaluation.ordered.table import Figure, OrderedCrossPlay
from overcooked_bench.rendering.table import Cell, Column, Table, styled

if TYPE_CHECKING:
    from rich.console import Group, RenderableType


def ordered_tables(found: OrderedCrossPlay) -> "Group":
    """Lays the table out for the terminal: each figure, then the mean of all of them, and what the numbers mean."""
    from rich.console import Group

    pools = ", ".join(f"{pool.name} ({pool.sha256[:8]})" for pool in found.pools)
    head = f"ordered cross-play · protocol {found.protocol.name} ({found.protocol.sha256[:8]}) · {pools}"
    parts: list[RenderableType] = [styled(head, style="bold"), styled("")]
    for figure in found.figures:
        parts += [
            styled(f"{figure.layout}, with {_partners(figure)}", style="bold"),
            _lines(found, figure.lines).terminal(),
        ]
        parts.append(styled(""))
    if len(found.figures) > 1:
        title = f"mean of these {len(found.figures)}, as the thesis's Table 7.3"
        parts += [styled(title, style="bold"), _lines(found, found.lines).terminal(), styled("")]
    parts += [styled(note, style="dim") for note in ordered_notes(found)]
    return Group(*parts)


def curves_csv(found: OrderedCrossPlay) -> str:
    """Writes every curve as CSV: one row per layout, kind of partners, entrant and share of the partners."""
    rule = found.rule
    heads = ["layout", "partners", "entrant", "rows", "share", "mean", *(f"q{quantile:g}" for quantile in rule.band)]
    heads += [f"q{rule.quantile:g}", *("minimum" if not q else f"q{q:g}" for q in rule.quantile_band), "maximum"]
    rows: list[list[Cell]] = []
    for figure in found.figures:
        for one in figure.curves:
            columns = zip(SHARES, one.mean, *one.band, one.quantile, *one.quantile_band, strict=True)
            start = [figure.layout, figure.partners, one.entrant, str(len(one.rows))]
            rows += [[*start, *(f"{value:g}" for value in (*values, figure.maximum))] for values in columns]
    return Table(heads, rows).csv()


def ordered_notes(found: OrderedCrossPlay) -> list[str]:
    """Returns notes on what the table does not show."""
    rule, everyone = found.rule, [one for some in found.figures for one in some.lines]
    said = [
        "Rows are agents, each with its partners in ascending order of their mean return "
        f"({found.episodes} start states, from both seats). At a share of the partners: the {rule.quantile:g} quantile "
        "over rows; 1 is the best pair of self-play agents on the layout. Pairs of one lineage, and of an agent that "
        "trained with the other, are omitted."
    ]
    needed = ceil(
        log(1 - CONFIDENCE) / log(1 - rule.quantile)
    )  # so that one of them is likely to be below the quantile
    counts = {len(one.rows) for some in found.figures for one in some.curves}
    if few := sorted(count for count in counts if count < needed):
        said.append(f"With {', '.join(map(str, few))} rows the quantile is descriptive: a lower bound needs {needed}.")
    if gains := [(some.layout, gain) for some in found.figures if (gain := _gain(some)) is not None]:
        listed = ", ".join(f"{gain:+.3f} ({layout})" for layout, gain in gains)
        said.append(
            "The same self-play agents, reported as the thesis reports a population (few rows, each the better of "
            f"two): {listed} in the average, without being any better; its largest effect is {THESIS_EFFECT:+.3f}. "
            "Compare equal numbers of rows, none of them chosen."
        )
    kept = {one.entrant for one in found.lines}
    if lost := list(dict.fromkeys(one.entrant for one in everyone if one.entrant not in kept)):
        said.append(f"Not in every figure, and so not in the mean: {', '.join(lost)}.")
    return said


def label(one: Line) -> str:
    """Returns what a line is called: `self-play, any 3` if rows were drawn, `self-play, 3 x better of 2`."""
    if not one.drawn:
        return one.entrant
    return f"{one.entrant}, {one.rows} x better of 2" if one.chosen else f"{one.entrant}, any {one.rows}"


def _gain(figure: Figure) -> float | None:
    """Returns what choosing and counting add to the average of self-play agents; None if they are too few."""
    chosen = next((one for one in figure.lines if one.chosen), None)
    return None if chosen is None else chosen.average - figure.lines[0].average


def _lines(found: OrderedCrossPlay, lines: Sequence[Line]) -> Table:
    heads = [Column("entrant", left=True), Column("rows", wrap=False)]
    heads += [Column(f"{100 * share:g} %", wrap=False) for share in found.rule.positions]
    rows: list[list[Cell]] = [
        [label(one), str(one.rows), *(f"{value:.3f}" for value in one.values), f"{one.average:.3f}"] for one in lines
    ]
    return Table([*heads, Column("average", wrap=False)], rows)


def _partners(figure: Figure) -> str:
    among = len(figure.curves[0].rows)
    whom = f"{among} self-play agents" if figure.partners == "self-play" else "one another"
    return f"{whom}; 1 = {figure.maximum:.0f} points"
