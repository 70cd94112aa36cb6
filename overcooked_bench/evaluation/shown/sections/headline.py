"""The headlines: numbers with intervals beside the reference, layout by layout as a plot, and as a table."""

from collections.abc import Iterator
from html import escape
from typing import Final

from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import Row, Scores
from overcooked_bench.evaluation.shown.card import card_table, columns_note
from overcooked_bench.evaluation.shown.comparison import title_of
from overcooked_bench.evaluation.shown.notes import short_notes
from overcooked_bench.evaluation.shown.sections.levels_plot import levels_plot
from overcooked_bench.evaluation.shown.sections.section import Material, Section, legend
from overcooked_bench.evaluation.shown.tables import figure, layouts_table
from overcooked_bench.rendering.page import note

_WIDEST: Final = 140
"""Characters of a table; columns of less interest are left out of one that is wider."""

STYLE: Final = """
div.cards { display: flex; flex-wrap: wrap; gap: 1rem; margin: 1rem 0 1.2rem; }
div.cards div { border: 1px solid var(--line); border-radius: 8px; padding: .7rem 1.1rem; background: var(--soft); }
div.cards b { font-size: 2.1rem; line-height: 1.15; font-weight: 650; } div.cards p { margin: 0; }
div.cards small { color: var(--dim); font-size: .95rem; }
@media (max-width: 40rem) { div.cards { gap: .6rem; } div.cards div { padding: .5rem .7rem; }
  div.cards b { font-size: 1.5rem; } div.cards small { font-size: .8rem; } }
"""


def headline_section(material: Material) -> Section:
    """Shows the headlines; of a score without an overall value those of each layout alone."""
    scores, facts = material.scores, material.headline
    table = (
        card_table(scores, material.around, _WIDEST)
        if scores.settings.report.headlines
        else layouts_table(scores, "report")
    )
    *said, _ = short_notes(scores, material.around)  # the last one is about the terminal
    parts, plots = [*_cards(material), *map(note, said)], {}
    if facts is not None and scores.layouts:
        plots["headline"] = levels_plot(material, facts, legend=True)
        shown = levels_plot(material, facts).element()
        parts += [legend(material.entrants), f'<div class="narrow">{shown}</div>']
    parts.append(table.html())
    if scores.settings.report.headlines and scores.layouts:
        parts.append(note(columns_note(scores)))
    return Section("Score", parts, {"score": table}, plots)


def _cards(material: Material) -> Iterator[str]:
    """Yields one card per headline of the mean over layouts."""
    scores, shown = material.scores, []
    names = scores.settings.report.headlines or (scores.headline,)
    for facts in (facts for name in names for facts in scores.metrics if facts.name == name):
        row = scores.find(facts.name)
        if row is None:
            continue
        number = figure(row.estimate, facts, scores.settings.report.ranked)
        error = number.interval if scores.settings.report.ranked else _standard_error(row, facts)
        said = _beside(material.reference, facts) if material.reference else ""
        shown.append(
            f"<div><p>{escape(title_of(facts))}</p><p><b>{escape(number.value)}</b> "
            f"<small>{escape(error)}</small></p><p><small>{escape(said)}</small></p></div>"
        )
    if shown:
        yield f'<div class="cards">{"".join(shown)}</div>'


def _standard_error(row: Row, facts: MetricFacts) -> str:
    """Writes what is known about a number that is not ranked."""
    factor = 100 if facts.unit == "share" else 1
    return "" if row.error is None else f"± {factor * row.error:.{facts.digits}f} (standard error)"


def _beside(reference: Scores, facts: MetricFacts) -> str:
    row = reference.find(facts.name)
    return f"{reference.agent.name} {figure(row.estimate, facts, False)}" if row else ""
