"""What was played, and what the numbers mean; and every partner with everything that is known about it."""

from collections.abc import Iterator
from html import escape

from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.evaluation.shown.cooperation import cooperation_cells_table
from overcooked_bench.evaluation.shown.notes import notes
from overcooked_bench.evaluation.shown.sections.section import Material, Section
from overcooked_bench.evaluation.shown.tables import cells_table, layouts_table, partners_table
from overcooked_bench.rendering.page import definitions, note
from overcooked_bench.rendering.table import Table


def metrics_section(material: Material) -> Section | None:
    """Lays out the metrics besides the headlines, the best and worst partners, and the floors."""
    scores = material.scores
    if not scores.layouts:
        return None
    tables = {"metrics": layouts_table(scores, "report")} if scores.settings.report.headlines else {}
    tables["floors"] = partners_table(scores)
    return Section("Every metric", [table.html() for table in tables.values()], tables)


def every_partner_section(material: Material) -> Section | None:
    """Lays out each layout's partners, folded away; None if nothing was played."""
    parts: list[str] = []
    tables: dict[str, Table] = {}
    for layout in material.scores.layouts:
        shown = {
            f"partners-on-{layout.layout}": cells_table(material.scores, layout),
            f"cooperation-on-{layout.layout}": cooperation_cells_table(material.scores, layout),
        }
        known = {name: table for name, table in shown.items() if table is not None}
        laid = "".join(table.html() for table in known.values())
        parts.append(f"<details><summary>{escape(layout.layout)}</summary>{laid}</details>")
        tables |= known
    return Section("Every partner", parts, tables) if tables else None


def notes_section(material: Material) -> Section:
    """Says what the numbers mean."""
    return Section("How to read it", [note(one) for one in notes(material.scores)])


def played_section(material: Material) -> Section:
    """Lists what identifies the score."""
    return Section("What was played", [definitions(pair for pair in _facts(material.scores) if pair[1])])


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
