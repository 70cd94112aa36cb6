"""`Estimate`: a number with its 95 % interval, and the intervals that every room uses."""

from collections.abc import Iterator, Sequence
from math import sqrt
from typing import Final

import msgspec
import numpy as np
from numpy.typing import ArrayLike

CONFIDENCE: Final = 0.95

_Z: Final = 1.959963984540054  # the 0.975-quantile of the standard normal distribution


class Estimate(msgspec.Struct, frozen=True):
    """A number with its 95 % interval; unpacks as `value, low, high`.

    Attributes:
        value: The estimate.
        low: Lower end, None if the data give none.
        high: Upper end, None if the data give none.
    """

    value: float
    low: float | None = None
    high: float | None = None

    def __iter__(self) -> Iterator[float | None]:
        yield from (self.value, self.low, self.high)

    def __str__(self) -> str:
        return self.text(2)

    @property
    def interval(self) -> tuple[float, float] | None:
        """Both ends, or None if there is no interval."""
        return None if self.low is None or self.high is None else (self.low, self.high)

    def text(self, digits: int = 1) -> str:
        """Writes `12.3 [10.0, 14.6]`, or the value alone if there is no interval."""
        value = f"{self.value:.{digits}f}"
        if self.interval is None:
            return value
        low, high = self.interval
        return f"{value} [{low:.{digits}f}, {high:.{digits}f}]"


def t_interval(values: ArrayLike, lowest: float = -np.inf, highest: float = np.inf) -> Estimate:
    """Computes the mean of independent values with Student's t interval.

    Args:
        values: (n,) one number per independent repetition: a training run, or an episode block of one run.
        lowest: The interval is clipped here, if nothing lower is possible.
        highest: And here, if nothing higher is.

    Returns:
        An estimate without an interval if n < 2.
    """
    given = np.asarray(values, np.float64)
    mean = float(given.mean())
    if len(given) < 2:
        return Estimate(mean)
    half = student(len(given) - 1) * float(given.std(ddof=1)) / len(given) ** 0.5
    return Estimate(mean, float(max(lowest, mean - half)), float(min(highest, mean + half)))


def ratio_interval(
    amounts: ArrayLike, weights: ArrayLike, lowest: float = -np.inf, highest: float = np.inf
) -> Estimate:
    """Computes a ratio of two sums over independent units, with Student's t interval.

    With equal weights it is the mean of the units' own ratios, and its interval that of `t_interval`.

    Args:
        amounts: (n,) what each unit counted, such as soups.
        weights: (n,) what it is counted per, such as steps; from 0, their sum above 0.
        lowest: The interval is clipped here, if nothing lower is possible.
        highest: And here, if nothing higher is.

    Returns:
        An estimate without an interval if n < 2.

    Source: Cochran 1977, "Sampling Techniques", 6.4 (the variance of a ratio estimate).
    """
    amount, weight = np.asarray(amounts, np.float64), np.asarray(weights, np.float64)
    ratio, n = float(amount.sum() / weight.sum()), len(amount)
    if n < 2:
        return Estimate(ratio)
    error = sqrt(n / (n - 1) * float(((amount - ratio * weight) ** 2).sum())) / float(weight.sum())
    half = student(n - 1) * error
    return Estimate(ratio, float(max(lowest, ratio - half)), float(min(highest, ratio + half)))


def welch_interval(first: ArrayLike, second: ArrayLike) -> Estimate:
    """Computes the difference of two independent means, the first minus the second, with Welch's t interval.

    Args:
        first: (n,) values.
        second: (m,) values.

    Returns:
        An estimate without an interval if n or m is less than 2.

    Source: Welch 1947, "The generalization of 'Student's' problem when several different population variances are
    involved".
    """
    return weighted_interval([(1, first), (-1, second)])


def weighted_interval(groups: Sequence[tuple[float, ArrayLike]]) -> Estimate:
    """Computes a weighted sum of independent means with a t interval: their difference, or a mean of differences.

    Args:
        groups: Weights, and (n,) independent values of each group; variances and sizes may differ.

    Returns:
        An estimate without an interval if a group has fewer than two values.

    Source: Satterthwaite 1946, "An approximate distribution of estimates of variance components".
    """
    weighted = [(weight, np.asarray(values, np.float64)) for weight, values in groups]
    total = float(sum(weight * values.mean() for weight, values in weighted))
    if min(len(values) for _, values in weighted) < 2:
        return Estimate(total)
    parts = [(weight**2 * float(values.var(ddof=1)) / len(values), len(values) - 1) for weight, values in weighted]
    variance = sum(part for part, _ in parts)
    if not variance:
        return Estimate(total, total, total)
    freedom = variance**2 / sum(part**2 / degrees for part, degrees in parts)
    half = student(freedom) * sqrt(variance)
    return Estimate(total, total - half, total + half)


def wilson(passed: float, n: float) -> Estimate:
    """Computes a share and its Wilson interval.

    Args:
        passed: Number that passed; may be fractional, if families count in part.
        n: Total number, fractional too; with 0 the interval is [0, 1].

    Source: Wilson 1927, "Probable inference, the law of succession, and statistical inference".
    """
    if not n:
        return Estimate(0.0, 0.0, 1.0)
    share, weight = passed / n, 1 + _Z**2 / n
    middle = (share + _Z**2 / (2 * n)) / weight
    half = _Z / weight * sqrt(share * (1 - share) / n + _Z**2 / (4 * n**2))
    return Estimate(share, max(0.0, middle - half), min(1.0, middle + half))


def student(freedom: float) -> float:
    """Returns the factor of a two-sided 95 % interval for a number of degrees of freedom."""
    from scipy.special import stdtrit  # scipy.stats takes far longer to import

    return float(stdtrit(freedom, (1 + CONFIDENCE) / 2))
