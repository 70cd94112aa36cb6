"""What a number of training seeds buys: how small a difference of two methods can be and still be seen."""

from collections.abc import Iterator, Sequence
from typing import Final

import msgspec

from overcooked_bench.evaluation.estimators import over_repetitions
from overcooked_bench.evaluation.metric import MetricFacts
from overcooked_bench.evaluation.scores import Row, Scores
from overcooked_bench.evaluation.statistics import detectable, seeds_needed

_STEP: Final = 0.1
"""A tenth of the range, for N and for shares."""


class Sight(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """What can be seen of one number.

    Attributes:
        layout: The layout; None for the mean over all.
        deviation: Standard deviation over training seeds, pooled over the scores.
        seen: Half the width of the interval of a difference with that deviation.
        step: A difference that one would like to see: a tenth of the range, or one soup.
        needed: Training seeds of each method from which on its interval excludes 0; None if a thousand do not.
    """

    layout: str | None = None
    deviation: float
    seen: float
    step: float
    needed: int | None


def sights(scores: Sequence[Scores], facts: MetricFacts) -> Iterator[Sight]:
    """Yields what the training seeds of several methods let one see of a metric, over all layouts and on each.

    Args:
        scores: With the same number of training seeds, two at least.
        facts: The metric; those with parameters are left out.
    """
    seeds = scores[0].training_seeds
    soups = {one.layout: one.soup_points for one in scores[0].layouts}
    for layout in (None, *soups):
        rows = [one.find(facts.name, layout=layout) for one in scores]
        variances = [_variance(row, seeds) for row in rows if row is not None]
        known = [variance for variance in variances if variance is not None]
        if len(known) < len(scores):
            continue
        deviation = (sum(known) / len(known)) ** 0.5
        step = min(soups.values()) if facts.unit == "points" else _STEP
        yield Sight(
            layout=layout,
            deviation=deviation,
            seen=detectable(deviation, seeds),
            step=step,
            needed=seeds_needed(step, deviation),
        )


def _variance(row: Row, seeds: int) -> float | None:
    """Returns the variance of a number over training seeds, None if the score does not say."""
    values = row.per_repetition or ()
    if len(values) != seeds or row.low is None:  # no values, or those of copies of a run
        return None
    error = over_repetitions(values).error if row.error is None else row.error
    return None if error is None else error**2 * seeds
