"""An explanation as tables, and notes on what they mean."""

from collections.abc import Iterator
from typing import TYPE_CHECKING, Final

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.explaining.reasons import FAILURES, PAIRINGS, REASONS
from overcooked_bench.evaluation.explaining.records import PREFIX, Explanation, Shares
from overcooked_bench.evaluation.pools.axes import AXES
from overcooked_bench.rendering.table import Cell, Column, Number, Table, styled

if TYPE_CHECKING:
    from rich.console import Group, RenderableType

NONE: Final = "-"
FEW: Final = 5
"""With fewer moments in which conventions differ, or agree, the terminal does not show an axis."""


def reasons_table(explanation: Explanation) -> Table:
    """Lays out one row per layout, one for all of them, and one per stratum of partners: shares of moments, in %."""
    heads = ["moments", "pair\nfails", *(REASONS[reason].heading for reason in FAILURES)]
    rows = [_reasons(one.layout, one.shares) for one in explanation.layouts]
    rows.append(_reasons("all layouts", explanation.total))
    if len(explanation.strata) > 1:
        rows += [_reasons(f"with {stratum}", shares) for stratum, shares in explanation.strata.items()]
    return Table([Column("", left=True, wrap=False), *heads], rows)


def soups_table(explanation: Explanation) -> Table:
    """Lays out one row per layout, and one for all of them: mean soups of each pairing."""
    heads = ["agent and\npartner", "two of\nthe agent", "two of\nthe partner", "two of\ngreedy"]
    named = [(one.layout, one.shares) for one in explanation.layouts] + [("all layouts", explanation.total)]
    rows: list[list[Cell]] = [
        [name, *(_number(shares.soups[pairing], 1) if shares.soups else NONE for pairing in PAIRINGS)]
        for name, shares in named
    ]
    return Table([Column("soups from there on", left=True, wrap=False), *heads], rows)


def conventions_table(explanation: Explanation, least: int = FEW) -> Table:
    """Lays out two rows per layout and axis: where conventions differ and where they agree; shares of moments, in %.

    Args:
        explanation: What to show.
        least: Moments that an axis needs on either side.
    """
    heads = [Column("layout", left=True, wrap=False), Column("conventions", left=True, wrap=False)]
    rows: list[list[Cell]] = [
        [
            *(one.layout, f"{axis.axis}: {'different' if axis.differ else 'the same'}", str(axis.shares.moments)),
            *(_percent(axis.shares.fails), _percent(axis.shares.reasons.get("clash"))),
        ]
        for one in explanation.layouts
        for axis in one.axes
        if len(sides := [other for other in one.axes if other.axis == axis.axis]) > 1
        and min(other.shares.moments for other in sides) >= least
    ]
    return Table([*heads, "moments", "pair\nfails", REASONS["clash"].heading], rows)


def worst_table(explanation: Explanation) -> Table:
    """Lays out the worst moments of all layouts: who, why, and mean soups of each pairing."""
    heads = [Column("worst moments", left=True, wrap=False), Column("partner", left=True), Column("reason", left=True)]
    rows: list[list[Cell]] = []
    for layout in explanation.layouts:
        for worst in layout.worst:
            moment = layout.moments[worst.moment]
            soups = (f"{moment.soups.mean(pairing):.1f}" for pairing in PAIRINGS)
            named = f" ({', '.join(moment.differ)})" if moment.reason == "clash" and moment.differ else ""
            rows.append([worst.name.removeprefix(PREFIX), moment.partner, f"{moment.reason}{named}", *soups])
    return Table([*heads, "pair", "agent", "partner", "greedy"], rows)


def notes(explanation: Explanation) -> Iterator[str]:
    """Yields what the tables mean, short."""
    yield (
        f"{explanation.steps} steps from moments in the middle of episodes, played by the pair, and by two copies of "
        f"the agent, of the partner, of greedy. Shares of moments in %, in brackets {explanation.interval}."
    )
    yield f"Works: {explanation.reasons['works']}. Else the pair fails."
    for reason in FAILURES:
        heading = REASONS[reason].heading.replace("\n", " ")
        yield f"{heading.capitalize()}: {explanation.reasons[reason]}."
    shown = {str(row[1]).partition(":")[0] for row in conventions_table(explanation).rows}
    axes = (axis for layout in explanation.layouts for axis in AXES.get(layout.layout, ()))
    meant = {axis.name: axis.meaning for axis in axes if axis.name in shown}
    if meant:
        yield f"Conventions: {'; '.join(f'{name}, {meaning}' for name, meaning in meant.items())}."


def explanation_tables(explanation: Explanation) -> "Group":
    """Lays an explanation out for the terminal."""
    from rich.console import Group

    head = f"{explanation.agent.name} · protocol {explanation.protocol.name} · pool {explanation.pool.name}"
    parts: list[RenderableType] = [styled(head, style="bold"), styled("")]
    for table in (reasons_table, soups_table, conventions_table, worst_table):
        laid = table(explanation)
        if laid.rows:
            parts += [laid.terminal(), styled("")]
    return Group(*parts, *(styled(note, style="dim") for note in notes(explanation)))


def _reasons(name: str, shares: Shares) -> list[Cell]:
    return [
        *(name, str(shares.moments), _percent(shares.fails)),
        *(_percent(shares.reasons.get(reason)) for reason in FAILURES),
    ]


def _percent(share: Estimate | None) -> Cell:
    if share is None:
        return NONE
    scaled = (None if end is None else 100 * end for end in (share.low, share.high))
    return _number(Estimate(100 * share.value, *scaled), 0)


def _number(estimate: Estimate, digits: int) -> Number:
    value, _, interval = estimate.text(digits).partition(" ")
    return Number(value, interval)
