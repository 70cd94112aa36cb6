"""Estimates and their intervals.

What varies is a training run, not an episode: seeds are the unit wherever there are two.

Axes: S training seeds, P partners, E episode indices.
"""

from math import ceil, sqrt
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.estimate import CONFIDENCE, Estimate, student, t_interval

LOW_QUANTILE: Final = 0.15
"""The quantile over training seeds, and the share of partners in the tail.

Source: the thesis, 7.2: the 0.15-quantile of the ordered outcomes.
"""

UNDECIDED: Final = 2.0
"""A partner nearer to a threshold than so many standard errors is on neither side of it for certain."""


class Threshold(NamedTuple):
    """How many partners reach a level.

    Attributes:
        reached: Partners with a mean of at least the level, averaged over training seeds; with its interval.
        undecided: Partners whose mean is within two standard errors of the level; None if no standard error is known.
    """

    reached: Estimate
    undecided: int | None


def threshold(returns: ArrayLike, level: float) -> Threshold:
    """Counts the partners that reach a level.

    With two training seeds or more the interval is t over the seeds' counts, clipped to what is possible. With one it
    runs from the partners that reach the level for certain to those that may, by two standard errors over episodes; a
    single episode of a single run gives neither an interval nor an error.

    Args:
        returns: (S, P, E) returns, averaged over seats.
        level: In the unit of the returns.
    """
    given = np.asarray(returns, np.float64)
    seeds, partners, episodes = given.shape
    means = given.mean(axis=2)
    counts = reached(means, level)
    middle = means.mean(axis=0)
    samples, n = (means.T, seeds) if seeds > 1 else (given[0], episodes)
    if n < 2:
        return Threshold(Estimate(float(counts[0])), None)
    errors = samples.std(axis=1, ddof=1) / n**0.5
    undecided = np.abs(middle - level) < UNDECIDED * errors
    if seeds > 1:
        return Threshold(t_interval(counts, 0, partners), int(undecided.sum()))
    certain = float(((middle >= level) & ~undecided).sum())
    return Threshold(Estimate(float(counts[0]), certain, certain + float(undecided.sum())), int(undecided.sum()))


def reached(means: ArrayLike, level: float) -> NDArray[np.float64]:
    """Counts each training seed's partners with a mean of at least a level: (S, P) -> (S,)."""
    return np.asarray((np.asarray(means, np.float64) >= level).sum(axis=1), np.float64)


def ordered(means: ArrayLike) -> NDArray[np.float64]:
    """Sorts each training seed's partners by their mean.

    Args:
        means: (S, P).

    Returns:
        (S, P), ascending along P: column r is the (r + 1)-th worst partner, which may differ between seeds.

    Source: the thesis, 7.2, "ordered outcomes".
    """
    return np.sort(np.asarray(means, np.float64), axis=1)


def low_quantile(values: ArrayLike, axis: int = 0) -> NDArray[np.float64]:
    """Returns the type-7 0.15-quantile along an axis: 0.4 x(1) + 0.6 x(2) for five values.

    Source: Hyndman and Fan 1996, definition 7.
    """
    return np.asarray(np.quantile(np.asarray(values, np.float64), LOW_QUANTILE, axis=axis, method="linear"))


def tail_quantile(means: ArrayLike) -> NDArray[np.float64]:
    """Returns each training seed's 0.15-quantile over partners: (S, P) -> (S,)."""
    return low_quantile(means, axis=1)


def tail_mean(means: ArrayLike) -> NDArray[np.float64]:
    """Returns each training seed's mean over its worst 15 % of the partners, one at least: (S, P) -> (S,)."""
    curve = ordered(means)
    return np.asarray(curve[:, : ceil(LOW_QUANTILE * curve.shape[1])].mean(axis=1))


def weighted_tail(values: ArrayLike, shares: ArrayLike, part: float) -> NDArray[np.float64]:
    """Returns each row's mean over its worst partners that have a part of the shares together; the last counts partly.

    Args:
        values: (R, P) with each partner.
        shares: (P,) shares of the partners, with the sum 1.
        part: Of the shares, above 0 and to 1.

    Returns:
        (R,)
    """
    given, weights = np.asarray(values, np.float64), np.asarray(shares, np.float64)
    order = np.argsort(given, axis=1, kind="stable")
    taken = np.clip(part - (np.cumsum(weights[order], axis=1) - weights[order]), 0, weights[order])
    return np.asarray((np.take_along_axis(given, order, axis=1) * taken).sum(axis=1) / taken.sum(axis=1))


def detectable(deviation: float, seeds: int) -> float:
    """Returns the half-width of the 95 % interval of a difference of two methods: what so many training seeds can see.

    Args:
        deviation: Standard deviation of a score over training seeds, of both methods.
        seeds: Training seeds of each, two at least.
    """
    return student(2 * seeds - 2) * deviation * sqrt(2 / seeds)


def seeds_needed(difference: float, deviation: float) -> int | None:
    """Returns how many training seeds each of two methods needs for an interval that excludes 0 at this difference.

    Args:
        difference: Of their scores, above 0.
        deviation: Standard deviation of a score over training seeds.

    Returns:
        Two at least; None if a thousand are not enough.
    """
    return next((seeds for seeds in range(2, 1001) if detectable(deviation, seeds) <= difference), None)


class OrderBound(NamedTuple):
    """A distribution-free bound on a quantile.

    Attributes:
        rank: The bound is the rank-th smallest value, from 1.
        confidence: How certain it is.
    """

    rank: int
    confidence: float


def upper_bound(n: int, quantile: float = LOW_QUANTILE) -> OrderBound | None:
    """Finds the smallest order statistic of n values that is an upper 95 % bound on a quantile; None where none is."""
    below = _binomial_cdf(n, quantile)
    for rank in range(1, n + 1):
        if below[rank - 1] >= CONFIDENCE:  # at most rank - 1 values lie below the quantile
            return OrderBound(rank, float(below[rank - 1]))
    return None


def lower_bound(n: int, quantile: float = LOW_QUANTILE) -> OrderBound | None:
    """Finds the largest order statistic of n values that is a lower 95 % bound on a quantile; None where none is."""
    below = _binomial_cdf(n, quantile)
    for rank in range(n, 0, -1):
        if 1 - below[rank - 1] >= CONFIDENCE:  # at least `rank` values lie below the quantile
            return OrderBound(rank, float(1 - below[rank - 1]))
    return None


def describe_low_quantile(values: ArrayLike) -> str:
    """Says what a few training seeds show about the 0.15-quantile over all seeds, and what they do not.

    Args:
        values: (S,) one score for each training seed, S >= 2.
    """
    seeds = np.sort(np.asarray(values, np.float64))
    n = len(seeds)
    low, high = lower_bound(n), upper_bound(n)
    listed = ", ".join(f"{value:.0f}" for value in seeds)
    kind = f"descriptive; seeds {listed}" if low is None else f"seeds {listed}"
    upper = f"{n} seeds give no upper bound on the population 0.15-quantile"
    if high is not None:
        value = seeds[high.rank - 1]
        upper = f"With {int(100 * high.confidence)} % confidence the population 0.15-quantile is <= {value:.0f}"
    lower = f"{n} seeds give no lower bound (needs {_seeds_for_lower_bound()})"
    if low is not None:
        lower = f"with {int(100 * low.confidence)} % confidence it is >= {seeds[low.rank - 1]:.0f}"
    return f"q0.15 over {n} training seeds: {float(low_quantile(seeds)):.0f} ({kind}). {upper}; {lower}."


def _seeds_for_lower_bound() -> int:
    return ceil(float(np.log(1 - CONFIDENCE) / np.log(1 - LOW_QUANTILE)))


def _binomial_cdf(n: int, p: float) -> NDArray[Any]:
    from scipy.stats import binom

    return np.asarray(binom.cdf(np.arange(n), n, p))
