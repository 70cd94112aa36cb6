"""The report of a score: one HTML page without external files, and on demand its plots and tables as files."""

from collections.abc import Iterable, Iterator, Sequence
from html import escape
from pathlib import Path
from typing import Final

from overcooked_bench.evaluation.beside import beside
from overcooked_bench.evaluation.comparing.compare import check_same_games
from overcooked_bench.evaluation.explaining.records import EXPLAIN_FILE, Explanation, ExplanationError, read_explanation
from overcooked_bench.evaluation.scores import EPISODES_FILE, REPORT_FILE, Scores
from overcooked_bench.evaluation.shown.figures import FORMS
from overcooked_bench.evaluation.shown.sections import headline, partners, section
from overcooked_bench.evaluation.shown.sections.conduct import conduct_section
from overcooked_bench.evaluation.shown.sections.curves import curves_section
from overcooked_bench.evaluation.shown.sections.failure import failure_section
from overcooked_bench.evaluation.shown.sections.headline import headline_section
from overcooked_bench.evaluation.shown.sections.partners import partners_section
from overcooked_bench.evaluation.shown.sections.played import (
    every_partner_section,
    metrics_section,
    notes_section,
    played_section,
)
from overcooked_bench.evaluation.shown.sections.scenarios import scenarios_section
from overcooked_bench.evaluation.shown.sections.seats import seats_section
from overcooked_bench.evaluation.shown.sections.section import Material, Section
from overcooked_bench.evaluation.shown.sections.worst import worst_section
from overcooked_bench.files import write_whole
from overcooked_bench.rendering.page import contents, note, page
from overcooked_bench.rendering.page import section as titled
from overcooked_bench.rendering.viewer.games import script

PLOTS_FOLDER: Final = "plots"
TABLES_FOLDER: Final = "tables"

_SECTIONS: Final = (
    headline_section,
    curves_section,
    partners_section,
    seats_section,
    conduct_section,
    scenarios_section,
    failure_section,
    worst_section,
    metrics_section,
    every_partner_section,
    notes_section,
    played_section,
)
_STYLE: Final = section.STYLE + headline.STYLE + partners.STYLE


def write_report(scores: Scores, folder: str | Path, others: Sequence[Scores] = ()) -> list[Section]:
    """Writes the page.

    Args:
        scores: What to show.
        folder: Where it is, and where the page is written; its episodes and explanation are shown.
        others: Chosen scores of the same games, which the plots show as well.

    Returns:
        The sections of the page, with their plots and tables.

    Raises:
        CompareError: A chosen score is of other games.
    """
    for other in others:
        check_same_games(scores.agent.name, scores, other.agent.name, other)
    material = gather(scores, Path(folder), others)
    shown = [made for make in _SECTIONS if (made := make(material)) is not None]
    body = [
        f"<h1>{escape(scores.agent.name)}</h1>",
        note(_subtitle(scores), "sub"),
        *_faults(scores.faults),
        contents(one.title for one in shown),
        *(part for one in shown for part in titled(one.title, *one.parts)),
    ]
    body += [script()] if any("data-kitchen" in part for part in body) else []
    write_whole(Path(folder) / REPORT_FILE, page(f"{scores.agent.name}: overcooked-bench score", body, _STYLE))
    return shown


def write_files(sections: Iterable[Section], folder: str | Path) -> list[Path]:
    """Writes each plot as PNG and SVG, and each table as CSV.

    Args:
        sections: From `write_report`.
        folder: Of the score; the files are in two folders in it.

    Returns:
        The files.
    """
    plots, tables = Path(folder) / PLOTS_FOLDER, Path(folder) / TABLES_FOLDER
    for home in (plots, tables):
        home.mkdir(parents=True, exist_ok=True)
    written = []
    for one in sections:
        for name, plot in one.plots.items():
            for form in FORMS:
                written.append(plots / f"{name}.{form}")
                plot.save(written[-1], form)
        for name, table in one.tables.items():
            written.append(tables / f"{name}.csv")
            write_whole(written[-1], table.csv())
    return written


def gather(scores: Scores, folder: Path, others: Sequence[Scores] = ()) -> Material:
    """Finds everything that the report of a score shows."""
    episodes = folder / EPISODES_FILE
    return Material(
        scores=scores,
        folder=folder,
        around=beside(scores, folder),
        others=tuple(others),
        explanation=_explanation(scores, folder),
        episodes=episodes if episodes.is_file() else None,
    )


def _faults(faults: Sequence[str]) -> Iterator[str]:
    """Yields the first fault of the agent, and the others folded away."""
    yield from (note(f"Fault: {fault}", "warn") for fault in faults[:1])
    if more := "".join(note(fault, "warn") for fault in faults[1:]):
        yield f"<details><summary>{len(faults) - 1} more faults</summary>{more}</details>"


def _explanation(scores: Scores, folder: Path) -> Explanation | None:
    """Reads the explanation of exactly this score; None if there is none, or one of another score."""
    if not (folder / EXPLAIN_FILE).is_file():
        return None
    try:
        found = read_explanation(folder)
    except ExplanationError:
        return None
    same = (found.agent, found.pool, found.protocol) == (scores.agent, scores.pool, scores.protocol)
    return found if same else None


def _subtitle(scores: Scores) -> str:
    pool = f", pool {scores.pool.name}" if scores.pool else ""
    seeds = f"{scores.training_seeds} training seed" + "s" * (scores.training_seeds > 1)
    return f"protocol {scores.protocol.name} version {scores.settings.version}{pool}, {seeds}"
