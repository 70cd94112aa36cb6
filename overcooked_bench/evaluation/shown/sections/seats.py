"""Seats and sides: how the score depends on which chef the agent is, and on where it starts."""

from collections.abc import Sequence
from typing import Any

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import MEAN, Scores
from overcooked_bench.evaluation.shown.comparison import title_of
from overcooked_bench.evaluation.shown.sections.section import Material, Section
from overcooked_bench.evaluation.shown.tables import NONE, figure, layout_name
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.rendering.page import note
from overcooked_bench.rendering.table import Cell, Column, Table


def seats_section(material: Material) -> Section | None:
    """Lays out one row per layout and seat, and one per side where the floor has several; the reference beside."""
    table = _table(material)
    if table is None:
        return None
    said = (
        "Seats are numbers of the two chefs. Sides are the parts of a floor that is divided: which one the agent "
        "starts on decides what it can reach. Points: mean return per episode."
    )
    return Section("Seats and sides", [table.html(), note(said)], {"seats": table})


def _table(material: Material) -> Table | None:
    scores = material.scores
    shown = [facts for facts in scores.metrics if facts.name in {MEAN, *scores.settings.report.headlines}]
    rows: list[list[Cell]] = []
    for layout in scores.layouts:
        places: list[tuple[str, dict[str, Any]]] = [
            (f"seat {seat}", {"seat": seat}) for seat in scores.settings.play.seats
        ]
        places += [(name, {"side": side}) for side, name in enumerate(side_names(layout.layout))]
        where = layout_name(layout)
        for name, about in places if len(places) > 1 else []:
            cells = [*_cells(scores, shown, layout.layout, about, True)]
            if material.reference is not None:
                cells += _cells(material.reference, shown, layout.layout, about, False)
            if any(cell != NONE for cell in cells):
                rows.append([where, name, *cells])
                where = ""
    titles = ["points" if facts.name == MEAN else title_of(facts) for facts in shown]
    heads = [Column(f"{title} [95 %]", wrap=False) for title in titles]
    if material.reference is not None:
        name = material.reference.agent.name
        heads += [Column(f"{name}\n{title}", wrap=False) for title in titles]
    return Table([Column("layout", left=True), Column("agent on", left=True), *heads], rows) if rows else None


def _cells(
    scores: Scores, shown: Sequence[MetricFacts], layout: str, about: dict[str, Any], interval: bool
) -> list[Cell]:
    found = ((scores.find(facts.name, layout=layout, **about), facts) for facts in shown)
    return [NONE if row is None else figure(row.estimate, facts, interval) for row, facts in found]


def side_names(name: str) -> list[str]:
    """Returns names of the separate parts of a layout's floor, such as "left side"; none if there is only one."""
    try:
        regions = Layout.load(name).regions
    except WrongUse:  # a kitchen of somebody else
        return []
    count = max(regions.values(), default=0) + 1
    if count != 2:
        return [f"side {number}" for number in range(count)] if count > 2 else []
    across, along = ([_middle(regions, side, axis) for side in (0, 1)] for axis in (0, 1))
    places, words = (across, ("left", "right")) if across[0] != across[1] else (along, ("top", "bottom"))
    return [f"{words[place > other]} side" for place, other in (places, places[::-1])]


def _middle(regions: dict[tuple[int, int], int], side: int, axis: int) -> float:
    cells = [cell[axis] for cell, region in regions.items() if region == side]
    return sum(cells) / len(cells)
