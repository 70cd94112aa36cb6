"""Says why a score is not to be ranked: what was played is not what the protocol means, or who played is no entrant."""

from collections import defaultdict
from collections.abc import Collection, Iterator
from hashlib import sha256
from typing import Any

from overcooked_bench.evaluation.estimators import FEWEST_RUNS
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.games.streams import is_drawn
from overcooked_bench.evaluation.metric import find_metrics
from overcooked_bench.evaluation.scores import Scores


def why_unranked(scores: Scores, different: int) -> str | None:
    """Says why a score on all layouts is not to be ranked with others of its kind, None if it is.

    Args:
        scores: The score.
        different: How many of its training runs differ, see `different_runs`.
    """
    return "; ".join((*_of_games(scores), *_of_entrant(scores, different))) or None


def different_runs(store: Store, layouts: Collection[str]) -> int:
    """Counts the training runs that differ from each other in any game: in its points or its joint actions.

    All training runs have the same start states and random streams, so copies of one agent play the same games.

    Args:
        store: Where the episodes are.
        layouts: Those that count.
    """
    games: defaultdict[int, Any] = defaultdict(sha256)
    for one in store.episodes():
        if one.layout in layouts:
            which = (one.layout, one.episode, one.partner, one.seat, one.soup_reward)
            games[one.training_seed].update(repr(which).encode() + one.actions)
    return len({game.digest() for game in games.values()})


def _of_games(scores: Scores) -> Iterator[str]:
    """Yields what is not as the protocol means it; a salt that was drawn is as good as the public one."""
    rules, pool = scores.settings, scores.pool
    if not rules.report.ranked:
        yield f"the protocol {rules.name} does not rank"
    if pool is not None and rules.play.pool_sha256 not in (None, pool.sha256):
        yield f"the pool {pool.name} is not that of the protocol {rules.name}"
    if scores.seed != 0:
        yield f"it has the seed {scores.seed}, and ranked scores have the seed 0"
    if scores.salt != rules.play.salt and not is_drawn(scores.salt):
        yield "its salt is neither the protocol's nor drawn by --salt fresh"
    if scores.layouts and scores.find(scores.headline) is None:
        titles = {metric.facts.name: metric.facts.label.partition(" ")[0] for metric in find_metrics()}
        title = titles.get(scores.headline, scores.headline)
        unbounded = any(one.counts and not one.bounds for layout in scores.layouts for one in layout.partners)
        why = f"the pool {pool.name if pool else 'none'} has no bounds for all partners, so " if unbounded else ""
        yield f"{why}there is no {title}"


def _of_entrant(scores: Scores, different: int) -> Iterator[str]:
    runs = scores.training_seeds
    if scores.settings.report.headlines and 1 < runs < FEWEST_RUNS:
        yield f"{runs} training runs; a method has {FEWEST_RUNS} at least, an agent one"
    if different < runs:
        yield f"{different} of its {runs} training runs differ, the others are copies"
    if any(one.is_ego and one.counts for layout in scores.layouts for one in layout.partners):
        yield f"{scores.agent.name} is itself among the partners"
