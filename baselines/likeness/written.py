"""The part of `results/human.md` that is computed: sentences around the tables."""

from collections.abc import Sequence
from typing import Any, Final

from overcooked_bench.human.people import SETS

from ..cloning import sweep
from .likeness import MOST_IDLE, SOUPS, SOUPS_EACH_OTHER, Likeness
from .proxies import SELF_PLAY_AGENTS, SELF_PLAY_POOL
from .tables import conduct_table, foretold_table, gates_table, stages_table, tries_table, verdict

SOUPS_PICTURE: Final = "human-soups.png"
VISITS_PICTURE: Final = "human-visits.png"

_HEAD: Final = f"""# Human proxies beside people

Proxies of the people of set A are in the pool `human-train`, those of set B in `human-test`; no person is in both.
`python -m overcooked_bench.baselines.human_report` writes this page; [humans.md](../../docs/humans.md) explains the
words.

{{verdict}}

![Soups of each pair of people, each proxy and each self-play agent]({SOUPS_PICTURE})

![Where people, proxies and self-play agents spend their time]({VISITS_PICTURE})

The second picture: share of the time on each cell, both chefs together, the mean over both sets."""

_GATES: Final = f"""## Gates

Each cell: whether the mean over the proxies is within the bounds, this mean, and how many of the proxies are within
them. A set's proxies are held against the people of that set, except for `nats`.

- nats: fewer per step than action frequencies need, on people of the other set
- idle: within {MOST_IDLE:.0f} points of people's
- soups, in percent of people's: {SOUPS[0]:.0f} to {SOUPS[1]:.0f} with itself, {SOUPS_EACH_OTHER[0]:.0f} to \
{SOUPS_EACH_OTHER[1]:.0f} with the other proxies of the set (all ordered pairs)
- cost: at most {sweep.MOST_NATS} nats per step more than the clone, on the run's held-out pairs"""

_FORETOLD: Final = f"""## How well they foretell people

Nats per step (fewer is better), and the share of steps on which the likeliest action was the one taken: means over
proxies and pairs of people, with 95 % intervals over pairs. Nothing was chosen on the other set, so these numbers are
unbiased. The held-out pairs are those of the set that a proxy did not learn from; they decided when cloning stopped,
and the coefficient. Action frequencies and last action are counted among the people that the proxies learned from.
Self-play agents: {SELF_PLAY_AGENTS} of `{SELF_PLAY_POOL}`."""

_CONDUCT: Final = """## What they do

Soups and hand-overs are per 400 steps. Agents play games of 1,200 steps from the standard start, with themselves
except where the row says otherwise. In brackets: 95 % over pairs of people, or the lowest and the highest agent or
pairing. The two distances, from 0 to 1, are total variation from the people of the set: of hand-overs by counter and
object, and of the time on each cell. The people of the other set are the yardstick."""

_COST: Final = """## What the second stage costs

Nats per step that each regularised proxy needs more than the clone that it was, on its held-out pairs and on the other
set (95 % intervals over pairs of people); soups and the distance of its idle share from people's, before and after."""

_RULE: Final = (sweep.__doc__ or "").split("\n\n")[1].strip()

_TRIES: Final = f"""### How the coefficient was chosen

{_RULE}
Coefficients are tried from the largest down, until one breaks the rule. Each try is one run with the input `lossless`
that learns with itself; the runs in the pools have other seeds, and may have other partners."""


def written(found: Sequence[Likeness], tries: Sequence[dict[str, Any]]) -> str:
    """Writes it in Markdown.

    Args:
        found: Proxies of one set or both.
        tries: As `cloning.sweep` keeps them; none leaves the section out.
    """
    sets = [pairs for pairs in SETS if any(one.pairs == pairs for one in found)]
    parts = [_HEAD.format(verdict=verdict(found)), _GATES, gates_table(found).markdown(), _FORETOLD]
    for pairs in sets:
        parts += [f"Proxies of set {pairs}:", foretold_table(found, pairs).markdown()]
    parts.append(_CONDUCT)
    for pairs in sets:
        parts += [f"Set {pairs}:", conduct_table(found, pairs).markdown()]
    parts += [_COST, stages_table(found).markdown()]
    if tries:
        parts += [_TRIES, tries_table(tries, found).markdown()]
    return "\n\n".join(parts) + "\n"
