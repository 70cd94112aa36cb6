"""Scores as a table for the terminal."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.scores import Cell, LayoutScore, ScenarioScore, Scores
from overcooked_bench.kitchen.layout import DEFAULT_SOUP_REWARD

if TYPE_CHECKING:
    from rich.console import Group
    from rich.table import Table


def score_tables(scores: Scores) -> "Group":
    """Lays a score out: one row a layout, worst and best partners and the floors below, and what the numbers mean."""
    from rich.console import Group
    from rich.text import Text

    pool = f"pool {scores.pool.name} ({scores.pool.sha256[:8]})" if scores.pool else "no pool"
    head = f"{scores.agent.name} · protocol {scores.protocol.name} ({scores.protocol.sha256[:8]}) · {pool}"
    blank = Text("")
    parts: list[Table | Text] = [Text(head, style="bold"), blank]
    if scores.layouts:
        parts += [_layouts(scores), blank, _partners(scores), blank]
    if scores.scenarios:
        parts += [_scenarios(scores.scenarios), blank]
    parts += [Text(note, style="dim") for note in notes(scores)]
    return Group(*parts)


def notes(scores: Scores) -> list[str]:
    """Says in words what the table does not: what the intervals are about, what is undecided, what was not played."""
    said = [f"Points per episode ({_worth(scores)}). {scores.interval}"]
    levels = ", ".join(f"{soups:g}" for soups in scores.settings.report.thresholds)
    if levels:
        said.append(f"≥{levels.replace(', ', ', ≥')}: share of partners with a mean of at least so many soups.")
    if any(layout.floors for layout in scores.layouts):
        said.append("Floors are played and shown, and enter no score.")
    undecided = [
        f"{threshold.undecided} at {threshold.soups:g} ({layout.layout})"
        for layout in scores.layouts
        for threshold in layout.thresholds
        if threshold.undecided
    ]
    if undecided:
        said.append(f"Partners within two standard errors of a threshold: {', '.join(undecided)}.")
    said += [f"{layout.layout}: {layout.low_quantile}" for layout in scores.layouts if layout.low_quantile]
    adapted = [layout.layout for layout in scores.layouts if layout.adapted]
    if adapted:
        said.append(f"Adapted (played by its mirror image): {', '.join(adapted)}.")
    if scores.not_attempted:
        said.append(f"Not attempted: {', '.join(scores.not_attempted)}.")
    if scores.scenarios:
        said.append("Scenarios: passed from each seat in each mirror; the mean of families counts alike ones as one.")
    if any(cell.is_ego for layout in scores.layouts for cell in layout.cells):
        said.append("* the scored agent itself is among the partners.")
    return said


def _worth(scores: Scores) -> str:
    """Returns what a soup pays, by layout where they differ."""
    worth = {layout.layout: layout.soup_points for layout in scores.layouts}
    if len(set(worth.values())) > 1:
        return "one soup = " + ", ".join(f"{points:g} on {layout}" for layout, points in worth.items())
    return f"one soup = {next(iter(worth.values()), DEFAULT_SOUP_REWARD):g}"


def interval_text(estimate: Estimate, digits: int = 1) -> str:
    """Writes `12.3 [10.0, 14.6]`, or the value alone where there is no interval."""
    if estimate.low is None or estimate.high is None:
        return f"{estimate.value:.{digits}f}"
    return f"{estimate.value:.{digits}f} [{estimate.low:.{digits}f}, {estimate.high:.{digits}f}]"


def cell_text(cell: Cell) -> str:
    """Writes `greedy* 12.3`."""
    return f"{cell.partner}{'*' if cell.is_ego else ''} {cell.mean.value:.1f}"


def _layouts(scores: Scores) -> "Table":
    """Draws means, seats and shares; 80 columns are enough."""
    table = plain_table("layout", "mean [95 %]", *(f"seat {seat}" for seat in scores.settings.play.seats))
    for soups in scores.settings.report.thresholds:
        table.add_column(f"≥{soups:g}", justify="right", no_wrap=True)
    for layout in scores.layouts:
        seats = [f"{seat.value:.1f}" for seat in layout.seats]
        shares = [f"{100 * threshold.share:.0f} %" for threshold in layout.thresholds]
        table.add_row(_name(layout), interval_text(layout.mean), *seats, *shares)
    if scores.overall and len(scores.layouts) > 1:
        table.add_section()
        table.add_row("mean of layouts", interval_text(scores.overall))
    return table


def _partners(scores: Scores) -> "Table":
    """Draws the worst and the best partner, and apart from them the floors."""
    floors = sorted({cell.partner for layout in scores.layouts for cell in layout.floors})
    table = plain_table("layout", "worst partner", "best partner", *(f"floor\n{name}" for name in floors))
    for layout in scores.layouts:
        found = {cell.partner: cell for cell in layout.floors}
        means = [f"{found[name].mean.value:.1f}" for name in floors]
        table.add_row(_name(layout), cell_text(layout.worst), cell_text(layout.best), *means)
    return table


def count_text(count: float) -> str:
    """Writes a count, or a mean of counts: `12`, `12.5`."""
    return f"{count:.1f}".removesuffix(".0")


def _scenarios(scenarios: ScenarioScore) -> "Table":
    """Draws what was passed by category."""
    table = plain_table("scenarios", "passed", "of", "mean of families [95 %]", "not attempted")
    for one in (*scenarios.categories, scenarios.total):
        if one is scenarios.total:
            table.add_section()
        missing = count_text(one.not_attempted) if one.not_attempted else "-"
        table.add_row(one.category, count_text(one.passed), str(one.items), interval_text(one.share, 2), missing)
    return table


def plain_table(first: str, *others: str, unbroken: Sequence[str] = ()) -> "Table":
    """Makes an empty table: the first column to the left, the others to the right; some are never wrapped."""
    from rich import box
    from rich.table import Table

    table = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False, show_edge=False)
    table.add_column(first, no_wrap=True)
    for name in others:
        table.add_column(name, justify="right", no_wrap=name in unbroken)
    return table


def _name(layout: LayoutScore) -> str:
    return layout.layout + (" (adapted)" if layout.adapted else "")
