"""The cooperation scenarios: a profile by category, and each of them."""

from overcooked_bench.evaluation.scores import ScenarioScore
from overcooked_bench.evaluation.shown.sections.section import Material, Section
from overcooked_bench.evaluation.shown.tables import NONE, scenarios_table
from overcooked_bench.rendering.page import note
from overcooked_bench.rendering.table import Cell, Column, Number, Table


def scenarios_section(material: Material) -> Section | None:
    """Lays out what was passed of what was attempted; None if no scenario was played."""
    scenarios = material.scores.scenarios
    if scenarios is None:
        return None
    reference = material.reference and material.reference.scenarios
    table = _beside(scenarios, reference, material) if reference else scenarios_table(scenarios)
    parts, tables = [table.html(), note("A profile, which enters no score.")], {"scenarios": table}
    if scenarios.scenarios:
        tables["every-scenario"] = _each(scenarios)
        parts.append(f"<details><summary>Every scenario</summary>{tables['every-scenario'].html()}</details>")
    return Section("Cooperation scenarios", parts, tables)


def _beside(scenarios: ScenarioScore, reference: ScenarioScore, material: Material) -> Table:
    """Adds the shares of the reference agent."""
    table = scenarios_table(scenarios)
    assert material.reference is not None
    known = (*reference.categories, reference.total)
    shares = {one.category: f"{one.share.value:.2f}" for one in known if one.share}

    def wider(rows: "list[list[Cell]]") -> list[list[Cell]]:
        return [[*row, shares.get(str(row[0]), NONE)] for row in rows]

    heads = [*table.columns, f"share of\n{material.reference.agent.name}"]
    return Table(heads, wider([*map(list, table.rows)]), wider([*map(list, table.foot)]))


def _each(scenarios: ScenarioScore) -> Table:
    rows: list[list[Cell]] = [
        [one.scenario, one.category, NONE if one.share is None else Number(f"{100 * one.share:.0f} %")]
        for one in scenarios.scenarios
    ]
    return Table(["scenario", Column("category", left=True), "situations passed"], rows)
