"""The part of the evidence page that is computed: sentences around the tables."""

import textwrap
from typing import Final

from overcooked_bench.estimate import Estimate
from overcooked_bench.rendering.table import Table

from .components import COMPONENTS
from .entrants import MOST_OF_A_FAMILY
from .entries import GREEDY, ORACLE
from .records import Evidence
from .scores import TWIN, WHOLE
from .tables import (
    bounds_table,
    conventions_table,
    correlation_of,
    entries_table,
    estimate_of,
    pool_table,
    predictors_table,
    reliability_table,
    validity_table,
    variance_table,
)
from .validity import HEADLINE, PEOPLE

CROSS_PLAY_PICTURE: Final = "crossplay"
PEOPLE_PICTURE: Final = "people"
PREDICTORS_PICTURE: Final = "predictors"
WITH_TWIN: Final = 0.8
"""Wanted of the correlation with the twin."""
WITH_PEOPLE: Final = 0.5
"""Wanted of the pooled correlation with proxies of people; on all layouts but one the interval is to be above 0."""
FEWEST: Final = 40, 8
"""Entrants and families that are wanted on each layout."""

_HEAD: Final = """# Evidence: the pool {pool}

`python -m overcooked_bench.baselines.v1_report` plays what has not been played and writes this page, its pictures and
`{pool}.json`, which has every number. Pool {pool} ({pool_hash}), {twin}; {episodes} episodes from each seat for each
pair of agents, from random starts.

N of an agent: (mean - floor) / (ceiling - floor) with each partner from each side of the floor, averaged with the
weights in the pool's manifest, the same weight for each stratum. Intervals are 95 %."""

_POOL: Final = """## The pool

![Points of every two partners]({pool}-crossplay.png)

Self-play: partners with copies of themselves; cross-play: pairs of different lineages; intervals for other agents of
the same kind. The effective number is 1 / mean similarity: how many partners that have nothing in common would be as
diverse, of how many there are; then the same in each stratum."""

_BOUNDS: Final = """Floor: the better of `stay` and `random`; ceiling: the best known responder; points per episode, the
lowest / median / highest over partners and sides."""

_CONVENTIONS: Final = "What partners do where agents have to agree; how many do so in brackets."

_VARIANCE: Final = """## Where the variance comes from

Entrants with the pool, shares of the variance of one episode's return; the last column is its standard deviation.
Method of moments for crossed random effects (`baselines/evidence/components.py`); estimates below zero count as zero.
Noise includes how an entrant fares with a particular start."""

_VALIDITY: Final = """## Does it rank agents as other partners do?

Entrants are agents of {sources}, and the scripted ones; at most {most} of a family, which is one trainer and
configuration. None shares a lineage, weights or a script with a partner of the pool, or has trained with one; scores
with other partners leave out those who are tied to them, common people included. Spearman's rank correlations;
intervals are Student's t over draws of whole families. Pooled: mean over layouts, families drawn on all at once.

{verdict}"""

_PREDICTORS: Final = """### Other predictors of the mean with human-test

All over the same entrants of each layout: those tied to no partner of any of these scores.

![Rank correlation of each predictor with the mean with human-test]({pool}-predictors.png)"""

_PEOPLE: Final = "![N without the human stratum, and the mean with human-test, of each entrant]({pool}-people.png)"

_RELIABILITY: Final = """### Reliability

Rank correlation of scores from two halves of the episodes, raised to all of them (2 r / (1 + r)): how far other
episodes with the same partners would give the same order."""

_ENTRIES: Final = """## Entries

N of what anybody would try first; means over training runs. A partner that is the entry itself is left out. `oracle`
meets each partner, from each side, as the best known responder to it: it is 1 but for the noise of episodes and
ceilings."""


def written(found: Evidence) -> str:
    """Writes it in Markdown.

    Args:
        found: Everything; parts that are missing are said to be missing.
    """
    pool = found.pool.name
    head = _HEAD.format(
        pool=pool,
        pool_hash=found.pool.sha256[:8],
        twin=f"twin {found.twin.name} ({found.twin.sha256[:8]})" if found.twin else "no twin",
        episodes=found.episodes,
    )
    validity = _VALIDITY.format(
        sources=_listed([f"`{one.name}`" for one in found.entrants_of]),
        most=MOST_OF_A_FAMILY,
        verdict="\n".join(f"- {line}" for line in [*_verdict(found), *_missing(found)]),
    )
    parts: list[str | Table] = [head, _POOL.format(pool=pool), pool_table(found), _BOUNDS, bounds_table(found)]
    parts += [_CONVENTIONS, conventions_table(found), _VARIANCE, variance_table(found), _note(found), validity]
    parts += [validity_table(found), _PEOPLE.format(pool=pool), _PREDICTORS.format(pool=pool), predictors_table(found)]
    parts += [_RELIABILITY, reliability_table(found), _ENTRIES, entries_table(found)]
    texts = [_wrapped(part) if isinstance(part, str) else part.markdown() for part in parts]
    return "\n\n".join(text for text in texts if text) + "\n"


def _wrapped(text: str) -> str:
    """Breaks the lines of paragraphs; headings, pictures and list items keep to themselves."""
    blocks = text.split("\n\n")
    return "\n\n".join(
        "\n".join(
            textwrap.fill(item, 120, subsequent_indent="  ", break_on_hyphens=False) for item in block.split("\n")
        )
        if block.startswith("- ")
        else textwrap.fill(block, 120, break_on_hyphens=False, break_long_words=False)
        for block in blocks
    )


def _verdict(found: Evidence) -> list[str]:
    """Says what was wanted, and what came out."""
    lines = []
    twins = [estimate_of(layout.correlations, WHOLE, TWIN) for layout in found.layouts]
    if any(twins):
        reached = sum(one is not None and one.value >= WITH_TWIN for one in twins)
        lines.append(
            f"(a) with the twin, wanted {WITH_TWIN:g}: reached on {reached} of {len(twins)} layouts; pooled "
            f"{_text(estimate_of(found.pooled, WHOLE, TWIN))}."
        )
    people = [estimate_of(layout.correlations, HEADLINE, PEOPLE) for layout in found.layouts]
    if any(people):
        above = sum(one is not None and one.low is not None and one.low > 0 for one in people)
        lines.append(
            f"(c) with human-test, lower end wanted above 0 on four of five layouts: it is on {above} of "
            f"{len(people)}; pooled {_text(estimate_of(found.pooled, HEADLINE, PEOPLE))}, wanted {WITH_PEOPLE:g}."
        )
    return lines


def _missing(found: Evidence) -> list[str]:
    """Says what the page does not have."""
    lines = [] if found.twin else ["Missing: no twin was given, so there is no (a) and no score with it."]
    entries = {entry.name for layout in found.layouts for entry in layout.entries}
    if not entries - {GREEDY, ORACLE}:
        lines.append("Missing: no entries were given, so the last table has only what is not trained.")
    if ORACLE not in entries:
        lines.append("Missing: the oracle; some best known responders are in none of the pools that were given.")
    least, families = FEWEST
    for letter, pair in (("a", (WHOLE, TWIN)), ("c", (HEADLINE, PEOPLE))):
        seen = {layout.layout: correlation_of(layout.correlations, *pair) for layout in found.layouts}
        few = [name for name, one in seen.items() if one and (one.entrants < least or one.families < families)]
        if few:
            lines.append(f"({letter}) has fewer than {least} entrants or {families} families on {_listed(few)}.")
    return lines


def _note(found: Evidence) -> str:
    """Explains what `-` means in the table of components."""
    if found.episodes < 2:
        return "One episode from each seat shows no components; play two at least."
    unknown = {name for layout in found.layouts for name in COMPONENTS if layout.variance.get(name) is None}
    return "`-`: the data cannot show it, such as sides on a floor of one region." if unknown else ""


def _text(rho: Estimate | None) -> str:
    return "unknown" if rho is None else rho.text(2)


def _listed(names: list[str]) -> str:
    return " and ".join(filter(None, [", ".join(names[:-1]), names[-1]]))
