"""How the scored agent and its partners cooperate, as a table beside the reference agent with the same partners."""

from typing import Final

from overcooked_bench.evaluation.metric import Params
from overcooked_bench.evaluation.scores import LayoutFacts, Scores
from overcooked_bench.evaluation.shown.tables import NONE, figure, layout_name, name_of, of_partners, partners_of
from overcooked_bench.rendering.table import Cell, Column, Table

_COLUMNS: Final = (
    ("soups", ("ego_soups", "partner_soups")),
    ("potted", ("pots", "pots")),
    ("handed\nover", ("hand_overs", "hand_overs")),
    ("blocked", ("blocked", "blocked")),
    ("idle", ("idle", "idle")),
)
"""Heading, and the metrics of the scored agent and of its partner."""
_CHEFS: Final[tuple[Params, ...]] = ({"chef": 0}, {"chef": 1})


def cooperation_table(scores: Scores, reference: Scores | None) -> Table | None:
    """Lays out what both chefs do per episode, on each layout; then what the reference agent and its partners do.

    Args:
        scores: What to show.
        reference: The reference agent's score; None if there is none.

    Returns:
        None if the score has none of it.
    """
    if not any(scores.select("pots")):
        return None
    pairs = [("agent", "its partners", scores)]
    if reference is not None:
        pairs.append((reference.agent.name, "its partners", reference))
    rows: list[list[Cell]] = []
    for layout in scores.layouts:
        names = [layout_name(layout), *[""] * (2 * len(pairs) - 1)]
        chefs = [(name, of, chef) for *both, of in pairs for chef, name in enumerate(both)]
        rows += [
            [first, str(name), *_cells(of, layout.layout, chef)]
            for first, (name, of, chef) in zip(names, chefs, strict=True)
        ]
    return Table(["layout", Column("chef", left=True), *(heading for heading, _ in _COLUMNS)], rows)


def cooperation_cells_table(scores: Scores, layout: LayoutFacts) -> Table | None:
    """Lays out what both chefs do per episode with each partner of a layout; None if the score has none of it."""
    names = {name for _, metrics in _COLUMNS for name in metrics}
    shown = [(facts, params) for facts, params in of_partners(scores, layout) if facts.name in names]
    if not shown:
        return None
    rows: list[list[Cell]] = []
    for label in partners_of(scores, layout):
        found = (
            (scores.find(facts.name, layout=layout.layout, partner=label.name, params=params), facts)
            for facts, params in shown
        )
        rows.append(
            [name_of(label), *(NONE if row is None else figure(row.estimate, facts, False) for row, facts in found)]
        )
    return Table(["partner", *(facts.heading(params) for facts, params in shown)], rows)


def _cells(scores: Scores, layout: str, chef: int) -> list[Cell]:
    known = {facts.name: facts for facts in scores.metrics}
    cells: list[Cell] = []
    for _, metrics in _COLUMNS:
        metric = metrics[chef]
        params = {} if metrics[0] != metrics[1] else dict(_CHEFS[chef])
        row = scores.find(metric, layout=layout, params=params)
        cells.append(NONE if row is None else figure(row.estimate, known[metric], False))
    return cells
