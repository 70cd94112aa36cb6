"""A score for the terminal."""

from typing import TYPE_CHECKING, Final

from overcooked_bench.evaluation.beside import Beside
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.evaluation.shown.card import WORST, card_table
from overcooked_bench.evaluation.shown.cooperation import cooperation_table
from overcooked_bench.evaluation.shown.notes import notes, short_notes
from overcooked_bench.evaluation.shown.tables import layouts_table, partners_table, scenarios_table
from overcooked_bench.rendering.table import styled

WIDTH: Final = 100

if TYPE_CHECKING:
    from rich.console import Group, RenderableType

    from overcooked_bench.rendering.table import Table


def score_tables(
    scores: Scores, shown_beside: Beside | None = None, explain: bool = False, width: int = WIDTH
) -> "Group":
    """Lays a score out: one table and short notes, or everything.

    Args:
        scores: What to show.
        shown_beside: The scores that it is shown beside, see `beside.beside`.
        explain: Whether thresholds, partners, cooperation and scenarios are shown too, and what the numbers mean.
        width: Characters of a line.
    """
    from rich.console import Group

    around = shown_beside or Beside()
    pool = f"pool {scores.pool.name} ({scores.pool.sha256[:8]})" if scores.pool else "no pool"
    head = f"{scores.agent.name} · protocol {scores.protocol.name} ({scores.protocol.sha256[:8]}) · {pool}"
    parts: list[RenderableType] = [styled(head, style="bold"), styled("")]
    for table in [*_main(scores, around, width), *(_others(scores, around) if explain else [])]:
        parts += [table.terminal(), styled("")]
    said = notes(scores) if explain else short_notes(scores, around)
    parts += [styled(note, style="dim") for note in said]
    return Group(*parts)


def _main(scores: Scores, around: Beside, width: int) -> "list[Table]":
    if not (scores.layouts or scores.declined):
        return []
    return [
        card_table(scores, around, width) if scores.settings.report.headlines else layouts_table(scores, "terminal")
    ]


def _others(scores: Scores, around: Beside) -> "list[Table]":
    headlines = scores.settings.report.headlines
    found = [layouts_table(scores, "terminal", (*headlines, WORST))] if headlines and scores.layouts else []
    found += [partners_table(scores)] if scores.layouts else []
    cooperation = cooperation_table(scores, around.reference)
    found += [cooperation] if cooperation else []
    return found + ([scenarios_table(scores.scenarios)] if scores.scenarios else [])
