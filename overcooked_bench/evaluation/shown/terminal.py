"""A score for the terminal."""

from typing import TYPE_CHECKING

from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.evaluation.shown.tables import layouts_table, notes, partners_table, scenarios_table

if TYPE_CHECKING:
    from rich.console import Group, RenderableType


def score_tables(scores: Scores) -> "Group":
    """Lays a score out: the table of layouts, worst and best partners and the floors, and what the numbers mean."""
    from rich.console import Group
    from rich.text import Text

    pool = f"pool {scores.pool.name} ({scores.pool.sha256[:8]})" if scores.pool else "no pool"
    head = f"{scores.agent.name} · protocol {scores.protocol.name} ({scores.protocol.sha256[:8]}) · {pool}"
    tables = [layouts_table(scores, "terminal")] if scores.layouts or scores.declined else []
    tables += [partners_table(scores)] if scores.layouts else []
    tables += [scenarios_table(scores.scenarios)] if scores.scenarios else []
    parts: list[RenderableType] = [Text(head, style="bold"), Text("")]
    for table in tables:
        parts += [table.terminal(), Text("")]
    parts += [Text(note, style="dim") for note in notes(scores)]
    return Group(*parts)
