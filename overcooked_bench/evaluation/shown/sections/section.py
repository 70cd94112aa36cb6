"""`Section`: a part of a report, with the plots and tables in it; and what all sections are made of."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Final, NamedTuple

from overcooked_bench.evaluation.beside import Beside
from overcooked_bench.evaluation.explaining.records import Explanation
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import MEAN, Scores
from overcooked_bench.evaluation.shown.figures import COLOURS, LINE, Plot
from overcooked_bench.rendering.table import Table

STYLE: Final = """
div.narrow { max-width: 32rem; margin-bottom: 1rem; }
div.panels { display: grid; gap: .2rem 1.2rem;
  grid-template-columns: repeat(auto-fill, minmax(min(19rem, 100%), 1fr)); }
div.panels h3 { font-weight: 600; font-size: .95rem; margin: .8rem 0 0; }
ul.legend { display: flex; flex-wrap: wrap; gap: 0 1.4rem; padding: 0; margin: .8rem 0 .3rem; list-style: none;
  font-size: .9rem; }
ul.legend li::before { content: ""; display: inline-block; width: 1.6rem; margin-right: .4rem; vertical-align: .25em;
  border-top: .2rem var(--dash) var(--mark); }
"""


class Entrant(NamedTuple):
    """An agent that a plot shows.

    Attributes:
        name: What it is called.
        scores: Its score.
        colour: Of its marks.
        reference: Whether it is the reference that everything is shown beside.
    """

    name: str
    scores: Scores
    colour: str
    reference: bool = False


@dataclass(frozen=True)
class Material:
    """What a report is about.

    Attributes:
        scores: The score.
        folder: Where it is; commands on the page name it.
        around: The reference agent, and the score under the criterion.
        others: Chosen scores, which the plots show as well.
        explanation: Why the agent failed; None if nobody asked.
        episodes: The store of the episodes; None if there is none.
    """

    scores: Scores
    folder: Path
    around: Beside = field(default_factory=Beside)
    others: tuple[Scores, ...] = ()
    explanation: Explanation | None = None
    episodes: Path | None = None

    @property
    def reference(self) -> Scores | None:
        """The score of the reference agent; None if there is none, or if it is the scored agent itself."""
        found = self.around.reference
        return None if found is None or found.agent == self.scores.agent else found

    @property
    def entrants(self) -> list[Entrant]:
        """The scored agent, the chosen ones, and the reference; of equal names the later ones have a number."""
        shown: list[Entrant] = []
        for scores in (self.scores, *self.others):
            name, number = scores.agent.name, 1 + sum(one.scores.agent.name == scores.agent.name for one in shown)
            colour = COLOURS[len(shown) % len(COLOURS)]
            shown.append(Entrant(name if number == 1 else f"{name} ({number})", scores, colour))
        if self.reference is not None:
            shown.append(Entrant(self.reference.agent.name, self.reference, LINE, reference=True))
        return shown

    @property
    def headline(self) -> MetricFacts | None:
        """How to show the metric that scores of this protocol are ranked by; None if nothing was played."""
        return next((facts for facts in self.scores.metrics if facts.name == self.scores.headline), None)

    @property
    def by_partner(self) -> MetricFacts | None:
        """How to show what single partners are shown by: the headline if it is known for them, else the mean return."""
        single = any(row.partner is not None for row in self.scores.select(self.scores.headline))
        name = self.scores.headline if single else MEAN
        return next((facts for facts in self.scores.metrics if facts.name == name), None)


class Section(NamedTuple):
    """A part of a report.

    Attributes:
        title: Its heading.
        parts: What is in it, as HTML.
        tables: Name -> a table of it, which is written as CSV.
        plots: Name -> a plot of it, which is written as PNG and SVG.
    """

    title: str
    parts: Sequence[str]
    tables: Mapping[str, Table] = {}
    plots: Mapping[str, Plot] = {}


def legend(entrants: Sequence[Entrant]) -> str:
    """Returns which line is whose, as HTML; nothing if there is only one."""
    if len(entrants) < 2:
        return ""
    looks = [("var(--dim)", "dashed") if one.reference else (one.colour, "solid") for one in entrants]
    items = "".join(
        f'<li style="--mark: {mark}; --dash: {dash}">{escape(one.name)}</li>'
        for one, (mark, dash) in zip(entrants, looks, strict=True)
    )
    return f'<ul class="legend">{items}</ul>'
