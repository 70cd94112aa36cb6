"""The ten worst cells, each a partner and a seat, with a game to watch."""

import shlex
from collections.abc import Sequence
from html import escape
from typing import Final, NamedTuple

from overcooked_bench.evaluation.games.recording import find_recording
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import MEAN, Row
from overcooked_bench.evaluation.shown.comparison import title_of
from overcooked_bench.evaluation.shown.sections.section import Material, Section
from overcooked_bench.evaluation.shown.tables import figure
from overcooked_bench.rendering.page import note
from overcooked_bench.rendering.table import Cell, Code, Column, Table
from overcooked_bench.rendering.viewer.games import pack_game, player

MOST: Final = 10
"""Cells that are shown."""


class WorstCell(NamedTuple):
    """A cell: the partner's number, which it is sorted by, and the mean return on the worse of the seats."""

    layout: str
    partner: str
    row: Row
    mean: Row


def worst_section(material: Material) -> Section | None:
    """Lists the worst cells, by the headline where it is known for single partners; None if nothing was played."""
    facts, found = material.by_partner, worst_cells(material)
    if facts is None or not found:
        return None
    table = _table(material, facts, found)
    if material.episodes is None:
        return Section("Worst cells", [table.html()], {"worst": table})
    said = "The worst partners, on the seat on which fewer points were reached; of each the episode with fewest points."
    games = [_game(material, facts, number, one) for number, one in enumerate(found, start=1)]
    return Section("Worst cells", [note(said), *games], {"worst": table})


def worst_cells(material: Material, most: int = MOST) -> list[WorstCell]:
    """Lists the worst partners of a score on its layouts, each on the worse seat; none if nothing was played."""
    facts, scores, found = material.by_partner, material.scores, []
    if facts is None:
        return []
    for layout in scores.layouts:
        for label, mean in scores.with_partners(layout):
            about = {"layout": layout.layout, "partner": label.name}
            seats = [row for seat in scores.settings.play.seats if (row := scores.find(**about, seat=seat))]
            worse = min(seats, key=lambda row: row.value, default=mean)
            found.append(WorstCell(layout.layout, label.name, scores.find(facts.name, **about) or mean, worse))
    return sorted(found, key=lambda one: (one.row.value, one.mean.value, one.layout, one.partner))[:most]


def _table(material: Material, facts: MetricFacts, found: Sequence[WorstCell]) -> Table:
    mean = next(one for one in material.scores.metrics if one.name == MEAN)
    rows: list[list[Cell]] = [
        [
            *(one.layout, one.partner, "" if one.mean.seat is None else str(one.mean.seat)),
            *(figure(one.row.estimate, facts, True), figure(one.mean.estimate, mean, False)),
            Code(_command(material, one)),
        ]
        for one in found
    ]
    heads: list[str | Column] = ["layout", Column("partner", left=True), "seat", title_of(facts), "points on this seat"]
    return Table([*heads, Column("watch its worst episode", left=True)], rows)


def _command(material: Material, one: WorstCell) -> str:
    seat = [] if one.mean.seat is None else ["--seat", str(one.mean.seat)]
    words = ["replay", str(material.folder), "--layout", one.layout, "--partner", one.partner, *seat, "--worst"]
    return shlex.join(["overcooked-bench", *words])


def _game(material: Material, facts: MetricFacts, number: int, one: WorstCell) -> str:
    assert material.episodes is not None
    recording = find_recording(
        *(material.episodes,), layout=one.layout, partner=one.partner, seat=one.mean.seat, worst=True
    )
    game = player(pack_game(recording.layout, recording.frames(), recording.names, recording.title))
    score = "" if facts.name == MEAN else f"{title_of(facts)} {figure(one.row.estimate, facts, False)}, "
    head = f"{number}. {one.layout}, {one.partner}, seat {recording.episode.seat}: {score}{one.mean.value:.0f} points"
    command = f'<p class="note"><code>{escape(_command(material, one))}</code></p>'
    said = note(recording.title)
    return f"<details{' open' * (number == 1)}><summary>{escape(head)}</summary>{said}{game}{command}</details>"
