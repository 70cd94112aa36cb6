"""Rank correlations of scores, with intervals over families of entrants.

Entrants of one family were trained in the same way and resemble each other, so whole families are drawn.

Axes: L layouts, n entrants of a layout, F families, D draws.
"""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.estimate import Estimate, student

FEWEST_FAMILIES: Final = 5
"""With fewer families nothing can be said about others of their kind."""
_DRAWS: Final = 2000


class Ranked(NamedTuple):
    """Two scores of the entrants of one layout.

    Attributes:
        families: (n,) the family of each entrant.
        first: (n,) one score.
        second: (n,) the other.
    """

    families: Sequence[str]
    first: NDArray[np.float64]
    second: NDArray[np.float64]


class Correlation(NamedTuple):
    """A rank correlation.

    Attributes:
        rho: With its 95 % interval over families; NaN if there are fewer than three entrants, or one score is the same
            for all of them.
        entrants: Number of entrants, over all layouts.
        families: F, number of families.
    """

    rho: Estimate
    entrants: int
    families: int


def spearman(first: ArrayLike, second: ArrayLike, weights: ArrayLike) -> NDArray[np.float64]:
    """Computes Spearman's rank correlation of entrants that are drawn repeatedly; equal values share their mean rank.

    Args:
        first: (n,) one score.
        second: (n,) the other.
        weights: (D, n) how often each entrant was drawn; from 0.

    Returns:
        (D,); NaN where all that were drawn have the same score.

    Source: Spearman 1904, "The proof and measurement of association between two things".
    """
    drawn = np.asarray(weights, np.float64)
    return _pearson(_ranks(np.asarray(first, np.float64), drawn), _ranks(np.asarray(second, np.float64), drawn), drawn)


def correlation(layouts: Sequence[Ranked]) -> Correlation:
    """Computes the rank correlation of two scores, over one layout or pooled over several.

    Pooled, it is the mean of the layouts' correlations, weighted by their numbers of entrants; a family that is drawn
    is drawn on every layout. The interval is Student's t with F - 1 degrees of freedom times the standard deviation
    over draws of F families with replacement, on Fisher's scale. In simulations with 8 and 12 families of two to eight
    entrants it covers the truth in 0.94 to 0.98 of the cases; the percentiles of the draws cover it in 0.91 to 0.96.

    Args:
        layouts: One for each layout.

    Source: Fisher 1921, "On the probable error of a coefficient of correlation".
    """
    names = sorted({family for one in layouts for family in one.families})
    entrants, count = sum(len(one.families) for one in layouts), len(names)
    rho = float(_pooled(layouts, names, np.ones((1, max(1, count))))[0]) if count else np.nan
    if np.isnan(rho) or count < FEWEST_FAMILIES:
        return Correlation(Estimate(rho), entrants, count)
    counts = np.random.default_rng(0).multinomial(count, np.full(count, 1 / count), _DRAWS)
    counts = counts[(counts > 0).sum(axis=1) > 1]  # one family alone shows nothing between families
    drawn = _pooled(layouts, names, counts.astype(np.float64))
    drawn = _fisher(drawn[np.isfinite(drawn)])
    if len(drawn) < 2:
        return Correlation(Estimate(rho), entrants, count)
    half = student(count - 1) * float(drawn.std()) * (count / (count - 1)) ** 0.5
    middle = float(_fisher(np.array(rho)))
    return Correlation(Estimate(rho, *np.tanh([middle - half, middle + half]).tolist()), entrants, count)


def _fisher(rho: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.asarray(np.arctanh(np.clip(rho, -0.999, 0.999)))


def _pooled(layouts: Sequence[Ranked], names: Sequence[str], counts: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the (D,) mean correlations of the layouts for (D, F) counts of families."""
    place = {name: index for index, name in enumerate(names)}
    total, weight = np.zeros(len(counts)), np.zeros(len(counts))
    for one in layouts:
        if len(one.families) < 3:
            continue
        drawn = counts[:, [place[family] for family in one.families]]
        rho = spearman(one.first, one.second, drawn)
        size = np.where(np.isfinite(rho), drawn.sum(axis=1), 0.0)
        total += np.where(size > 0, rho, 0.0) * size
        weight += size
    return np.asarray(np.divide(total, weight, out=np.full(len(counts), np.nan), where=weight > 0))


def _ranks(score: NDArray[np.float64], drawn: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns the (D, n) mean ranks of (n,) scores, each entrant counted as often as it was drawn."""
    below = score[:, None] > score[None, :]
    equal = score[:, None] == score[None, :]
    return np.asarray(drawn @ below.T + (drawn @ equal.T + 1) / 2)


def _pearson(
    first: NDArray[np.float64], second: NDArray[np.float64], weights: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Returns the (D,) weighted correlations of (D, n) values."""
    total = weights.sum(axis=1, keepdims=True)
    x, y = (values - (weights * values).sum(axis=1, keepdims=True) / total for values in (first, second))
    product = (weights * x * y).sum(axis=1)
    scale = np.sqrt((weights * x**2).sum(axis=1) * (weights * y**2).sum(axis=1))
    flat = scale <= 1e-9
    return np.where(flat, np.nan, product / np.where(flat, 1.0, scale))
