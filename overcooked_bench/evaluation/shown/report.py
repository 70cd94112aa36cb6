"""A score as one HTML page without external files: tables, the ordered curve, the worst pairs."""

import shlex
from collections.abc import Iterator
from html import escape
from io import BytesIO
from pathlib import Path
from typing import Final

from overcooked_bench.evaluation.scores import MEAN, Scores
from overcooked_bench.evaluation.shown.notes import notes
from overcooked_bench.evaluation.shown.plots import draw_curve, follow_theme
from overcooked_bench.evaluation.shown.tables import (
    cells_table,
    figure,
    layouts_table,
    name_of,
    partners_table,
    scenarios_table,
)
from overcooked_bench.files import write_whole
from overcooked_bench.rendering.page import definitions, note, page, section
from overcooked_bench.rendering.table import Cell, Code, Column, Table

MOST_WORST: Final = 10
"""Pairs that are listed as the worst."""


def write_report(scores: Scores, file: str | Path) -> None:
    """Writes the report.

    Args:
        scores: What to show.
        file: Where to; the commands on the page name its folder.
    """
    tables = [layouts_table(scores, "report")] if scores.layouts or scores.declined else []
    tables += [partners_table(scores)] if scores.layouts else []
    body = [
        f"<h1>{escape(scores.agent.name)}</h1>",
        note(_subtitle(scores), "sub"),
        *(note(f"Fault: {fault}", "warn") for fault in scores.faults),
        *section("Scores", *(table.html() for table in tables), *map(note, notes(scores))),
        *section("Ordered curve", *_curve(scores)),
        *section("Worst pairs", *_worst(scores, Path(file).parent)),
        *section("Cooperation scenarios", scenarios_table(scores.scenarios).html() if scores.scenarios else ""),
        *section("Every partner", *_partners(scores)),
        *section("What was played", definitions(_facts(scores))),
    ]
    write_whole(file, page(f"{scores.agent.name}: overcooked-bench score", body))


def _subtitle(scores: Scores) -> str:
    pool = f", pool {scores.pool.name}" if scores.pool else ""
    seeds = f"{scores.training_seeds} training seed" + "s" * (scores.training_seeds > 1)
    return f"protocol {scores.protocol.name} version {scores.settings.version}{pool}, {seeds}"


def _curve(scores: Scores) -> Iterator[str]:
    if not scores.layouts:
        return
    buffer = BytesIO()
    draw_curve(scores, buffer, "svg")
    yield f"<figure>{follow_theme(buffer.getvalue().decode())}</figure>"
    said = "Partners in ascending order of their mean, sorted separately for each training seed."
    yield note(said + " One training run: no bands." * (scores.training_seeds < 2))


def _worst(scores: Scores, folder: Path) -> Iterator[str]:
    pairs = sorted(
        ((layout.layout, label, row) for layout in scores.layouts for label, row in scores.with_partners(layout)),
        key=lambda pair: (pair[2].value, pair[0], pair[1].name),
    )[:MOST_WORST]
    if not pairs:
        return
    mean = next(facts for facts in scores.metrics if facts.name == MEAN)
    rows: list[list[Cell]] = [
        [layout, name_of(label), figure(row.estimate, mean), Code(_replay_command(folder, layout, label.name))]
        for layout, label, row in pairs
    ]
    command = Column("watch its worst episode", left=True)
    yield Table(["layout", Column("partner", left=True), mean.heading({}), command], rows).html()


def _replay_command(folder: Path, layout: str, partner: str) -> str:
    words = ["overcooked-bench", "replay", str(folder), "--layout", layout, "--partner", partner, "--worst"]
    return shlex.join(words)


def _partners(scores: Scores) -> Iterator[str]:
    for layout in scores.layouts:
        table = cells_table(scores, layout)
        yield f"<details><summary>{escape(layout.layout)}</summary>{table.html()}</details>"


def _facts(scores: Scores) -> Iterator[tuple[str, str]]:
    s, suite = scores.settings.play, scores.scenarios and scores.scenarios.suite
    yield "agent", f"{scores.agent.name}, SHA-256 {scores.agent.sha256}"
    yield "protocol", f"{scores.protocol.name}, version {scores.settings.version}, SHA-256 {scores.protocol.sha256}"
    yield "pool", f"{scores.pool.name}, SHA-256 {scores.pool.sha256}" if scores.pool else "none"
    yield "episodes", f"{s.episodes} start states per partner, {s.horizon} steps, cooking {s.cooking}, start {s.start}"
    yield "frozen policies", f"mode {s.mode}"
    yield "seed", str(scores.seed)
    yield "salt", scores.salt
    yield "run", ", ".join(f"{key} {value}" for key, value in scores.run.items() if not isinstance(value, dict))
    yield "scenarios", f"{suite.name}, SHA-256 {suite.sha256}" if suite else "not played"
    versions = scores.run.get("versions", {})
    yield "versions", ", ".join(f"{key} {value}" for key, value in versions.items())
