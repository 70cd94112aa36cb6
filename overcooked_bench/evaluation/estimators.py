"""How sure a number is: its standard error, over training seeds, or over the partners of a single training run.

Axes: R repetitions (training seeds, or episode blocks of a single run), P partners.
"""

from collections.abc import Iterable, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.estimate import Estimate, student

FEWEST_RUNS: Final = 5
"""Training runs from which on an entry is a method. With fewer, an interval over them is too wide to rank by."""


class Figure(NamedTuple):
    """A number with its standard error.

    Attributes:
        value: The number.
        error: Its standard error; None if the data give none.
        freedom: Degrees of freedom of the standard error.
    """

    value: float
    error: float | None = None
    freedom: float = 0.0

    def estimate(self, lowest: float = -np.inf, highest: float = np.inf) -> Estimate:
        """Returns the number with Student's 95 % interval, clipped to what is possible."""
        if self.error is None:
            return Estimate(self.value)
        half = student(self.freedom) * self.error
        return Estimate(self.value, float(max(lowest, self.value - half)), float(min(highest, self.value + half)))


class Group(NamedTuple):
    """Partners that a number is a mean over, all of them on one layout.

    Attributes:
        values: (P,) the number with each partner.
        shares: (P,) each partner's share of the mean; their sum is this layout's share.
        strata: (P,) the partner's stratum.
    """

    values: NDArray[np.float64]
    shares: NDArray[np.float64]
    strata: Sequence[str]


def over_repetitions(values: ArrayLike, least: float = 0.0, added: float = 0.0) -> Figure:
    """Computes a mean over independent repetitions, with Student's standard error.

    Args:
        values: (R,) one number for each.
        least: The variance of one repetition is no less than this, see `count_variance`.
        added: This is added to it first, see `rounding_variance`.

    Returns:
        A figure without an error if R < 2.
    """
    given = np.asarray(values, np.float64)
    if len(given) < 2:
        return Figure(float(given.mean()))
    variance = max(float(given.var(ddof=1)) + added, least)
    return Figure(float(given.mean()), (variance / len(given)) ** 0.5, len(given) - 1)


def over_partners(groups: Iterable[Group], least: float = 0.0) -> Figure:
    """Computes a weighted mean over partners, with its error over the partners of each stratum and their start states.

    Start states are drawn for each partner, so what partners of a stratum differ by contains what starts do. Layouts
    and strata are independent of each other; partners of a layout that has a stratum of one are a single stratum.

    Args:
        groups: One for each layout; all shares together sum to 1.
        least: The variance of the mean is no less than this.

    Returns:
        A figure without an error if a layout has a single partner.

    Source: Cochran 1977, "Sampling Techniques", 5 (stratified samples) and 6.4 (ratio estimates); Satterthwaite 1946.
    """
    value, parts = 0.0, []
    for values, shares, strata in groups:
        value += float(values @ shares)
        names, index = np.unique(np.asarray(strata), return_inverse=True)
        if np.bincount(index).min() < 2:
            names, index = names[:1], np.zeros(len(values), np.int64)
        for stratum in range(len(names)):
            inside = index == stratum
            parts.append(_within(values[inside], shares[inside]))
    if any(part is None for part in parts):
        return Figure(value)
    variances = np.array([part[0] for part in parts if part])
    freedoms = np.array([part[1] for part in parts if part])
    total = float(variances.sum())
    freedom = total**2 / float((variances**2 / freedoms).sum()) if total else float(freedoms.sum())
    return Figure(value, max(total, least) ** 0.5, freedom)


def _within(values: NDArray[np.float64], shares: NDArray[np.float64]) -> tuple[float, int] | None:
    """Returns the variance of a stratum's part of a mean, and its degrees of freedom; None for a single partner."""
    n = len(values)
    if n < 2:
        return None
    mean = float(values @ shares / shares.sum())
    return n / (n - 1) * float((shares**2 * (values - mean) ** 2).sum()), n - 1


def count_variance(reached: ArrayLike, shares: ArrayLike) -> float:
    """Returns the least variance of the share of partners that one training run reaches.

    Where all runs agree on every partner, their spread is 0, although the next run need not agree. So half a run more
    counts as reaching each partner, and half a run as missing it.

    Args:
        reached: (R, P) bool, whether each run reaches each partner.
        shares: (P,) each partner's share.
    """
    given = np.asarray(reached, np.float64)
    chance = (given.sum(axis=0) + 0.5) / (len(given) + 1)
    return float((np.asarray(shares, np.float64) ** 2 * chance * (1 - chance)).sum())


def rounding_variance(soup_points: float, seats: int) -> float:
    """Returns what a partner's block mean varies by because returns are whole soups: uniform over one soup, each seat.

    A few blocks with the same partner often have the same return, and so no spread at all.

    Args:
        soup_points: Points of one soup.
        seats: Episodes that a block has with one partner.
    """
    return soup_points**2 / (12 * seats)
