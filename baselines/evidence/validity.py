"""The rank correlations that show whether a pool ranks agents as other partners do."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from .ranks import Correlation, Ranked, correlation, spearman
from .records import CorrelationRecord
from .scores import HUMAN, MEAN, ONLY, PLAIN, SELF_PLAY, TWIN, WHOLE, WITHOUT, Scores

PEOPLE: Final = MEAN.format("human-test")
"""The score that the pool's own one is held against: proxies of people whom nobody in the pool was made from."""
CLONES: Final = MEAN.format("human-train")
"""The best that could be expected of a predictor: proxies of other people, made in the same way."""
HEADLINE: Final = WITHOUT.format(HUMAN)
PREDICTORS: Final = (
    HEADLINE,
    WHOLE,
    PLAIN,
    MEAN.format("dev-v1"),
    MEAN.format("dev-v0"),
    SELF_PLAY,
    CLONES,
)
"""Scores that are compared as predictors of `PEOPLE`, all over the same entrants."""
SAME: Final = "over the same entrants: "

Pair = tuple[str, str]


def pairs(strata: Sequence[str]) -> list[Pair]:
    """Lists the pairs of scores that are correlated, for the strata of a pool."""
    left_out = [(WITHOUT.format(stratum), ONLY.format(stratum)) for stratum in strata]
    return [(WHOLE, TWIN), *left_out, (HEADLINE, PEOPLE)]


def correlations(layouts: Sequence[tuple[Sequence[str], Scores]], strata: Sequence[str]) -> list[CorrelationRecord]:
    """Computes all correlations of one layout, or pooled over several.

    Args:
        layouts: For each layout the families of the entrants, and their scores.
        strata: Those of the pool.

    Returns:
        The pairs of `pairs`, each over all entrants that have both scores; then each of `PREDICTORS` with `PEOPLE`, its
        name after `SAME`, over the entrants that have all of them. Pairs of a score that is missing on every layout are
        left out.
    """
    found = []
    for first, second in pairs(strata):
        ranked = [_ranked(families, scores, first, second, (first, second)) for families, scores in layouts]
        found += _record(first, second, [one for one in ranked if one is not None])
    for first in PREDICTORS:
        ranked = [
            _ranked(families, scores, first, PEOPLE, [name for name in (*PREDICTORS, PEOPLE) if name in scores])
            for families, scores in layouts
        ]
        found += _record(SAME + first, PEOPLE, [one for one in ranked if one is not None])
    return found


def reliabilities(one: Scores, other: Scores) -> dict[str, float]:
    """Estimates how far ranks over all episodes would be repeated, from scores over two halves of them.

    Returns:
        By score 2 r / (1 + r), with the halves' rank correlation r; scores without three entrants are left out.

    Source: Spearman 1910 and Brown 1910.
    """
    found = {}
    for name, first in one.items():
        known = np.isfinite(first) & np.isfinite(other[name])
        if known.sum() >= 3:
            r = float(spearman(first[known], other[name][known], np.ones((1, int(known.sum()))))[0])
            if np.isfinite(r) and r > -1:
                found[name] = 2 * r / (1 + r)
    return found


def _ranked(families: Sequence[str], scores: Scores, first: str, second: str, needed: Sequence[str]) -> Ranked | None:
    """Returns two scores of the entrants that have all scores needed; None where a score is missing."""
    if first not in scores or second not in scores:
        return None
    known = np.all([np.isfinite(scores[name]) for name in needed], axis=0)
    kept = [family for family, there in zip(families, known, strict=True) if there]
    return Ranked(kept, scores[first][known], scores[second][known])


def _record(first: str, second: str, ranked: Sequence[Ranked]) -> list[CorrelationRecord]:
    if not ranked:
        return []
    found: Correlation = correlation(ranked)
    rho = found.rho if np.isfinite(found.rho.value) else None
    return [CorrelationRecord(first=first, second=second, rho=rho, entrants=found.entrants, families=found.families)]
