"""Shares and means over moments, with intervals that know what moments have in common.

Axes: n moments.
"""

from collections.abc import Hashable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.estimate import Estimate, ratio_interval, student, wilson


def share_interval(hits: ArrayLike, *units: Sequence[Hashable]) -> Estimate:
    """Computes the share of moments that have something, with a 95 % interval.

    Moments are no independent draws: those with one partner share its habits, and those of one training seed its
    network. Resampling moments would pretend that 50 of them were 50 agents with 50 partners. So whole units are
    compared: the variance of the share is that between partners (ratio estimate, as units have different numbers of
    moments), and likewise between training seeds where there are two or more. Moments are then worth as many
    independent ones as have this variance, never more than there are, and fewer units have fewer degrees of freedom.
    Wilson's interval for that number stays honest where no moment or every moment has it, where the variance between
    units is 0 and a t interval would have no width. Of partners and training seeds, the one that gives the wider
    interval rules.

    Args:
        hits: (n,) whether each moment has it.
        units: For each kind of unit (n,) the unit of each moment; kinds with a single unit are left out.

    Returns:
        An estimate without an interval if no kind has two units.

    Source: Korn and Graubard 1998, "Confidence intervals for proportions with small expected number of positive counts
    estimated from survey data" (effective sample size with degrees of freedom); Cochran 1977, "Sampling Techniques",
    6.4 and 9.7 (ratio estimate over clusters); Wilson 1927.
    """
    values = np.asarray(hits, np.float64)
    kinds = [kind for kind in units if len(set(kind)) > 1]
    share = float(values.mean())
    if not kinds:
        return Estimate(share)
    worth = min(_worth(values, kind) for kind in kinds)
    return Estimate(share, *(wilson(share * worth, worth).interval or ()))


def mean_interval(values: ArrayLike, *units: Sequence[Hashable]) -> Estimate:
    """Computes a mean over moments with Student's t interval over whole units, the wider of the kinds of units.

    Args:
        values: (n,) a number for each moment, from 0.
        units: As for `share_interval`.

    Returns:
        An estimate without an interval if no kind has two units.
    """
    given = np.asarray(values, np.float64)
    found = [ratio_interval(*_sums(given, kind), lowest=0) for kind in units if len(set(kind)) > 1]
    return max(found, key=_width, default=Estimate(float(given.mean())))


def _width(estimate: Estimate) -> float:
    low, high = estimate.interval or (0.0, 0.0)
    return high - low


def _sums(values: NDArray[np.float64], units: Sequence[Hashable]) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Returns the sum of the values and the number of moments of each unit."""
    known = {unit: index for index, unit in enumerate(dict.fromkeys(units))}
    index = [known[unit] for unit in units]
    amounts = np.asarray(np.bincount(index, weights=values), np.float64)
    return amounts, np.bincount(index).astype(np.float64)


def _worth(values: NDArray[np.float64], units: Sequence[Hashable]) -> float:
    """Returns how many independent moments these are worth."""
    amounts, weights = _sums(values, units)
    n, groups, share = len(values), len(weights), float(values.mean())
    between = groups / (groups - 1) * float(((amounts - share * weights) ** 2).sum()) / n**2
    alone = share * (1 - share) / (n - 1)
    design = max(1.0, between / alone) if alone else 1.0
    return n / design * min(1.0, (student(n - 1) / student(groups - 1)) ** 2)
