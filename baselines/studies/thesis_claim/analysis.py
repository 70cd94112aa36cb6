"""The analysis that plan.md registers: pure functions of numbers per block.

Axes: n blocks.
"""

from collections.abc import Sequence
from typing import Any, Final, Literal

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.evaluation.comparing.permutation import holm

ALPHA: Final = 0.05
"""Error that is accepted for a family of tests together."""
SMALLEST: Final = 0.05
"""Smallest difference of N that is of interest."""

Verdict = Literal["supported", "refuted", "undecided"]


class Difference(msgspec.Struct, frozen=True, kw_only=True):
    """The mean of paired differences over blocks.

    Attributes:
        blocks: n.
        value: The mean.
        spread: Standard deviation over blocks.
        low: Lower end of the interval.
        high: Upper end.
        level: Of the interval, such as 0.95.
        p: Two-sided p of no difference, alone.
        adjusted: The same adjusted for its family by Holm's procedure; p itself where it is in none.
    """

    blocks: int
    value: float
    spread: float
    low: float
    high: float
    level: float
    p: float
    adjusted: float


def difference(values: ArrayLike, alpha: float = ALPHA, adjusted: float | None = None) -> Difference:
    """Computes Student's t interval and test of paired differences.

    Args:
        values: (n,) one difference per block.
        alpha: 1 less the level of the interval.
        adjusted: The p adjusted for a family; p itself if it is in none.

    Raises:
        ValueError: Fewer than two blocks, which have no interval.
    """
    given = np.asarray(values, np.float64)
    if given.ndim != 1 or len(given) < 2:
        raise ValueError(f"differences of the shape {given.shape}; give (n,) with two blocks at least")
    from scipy.special import stdtr, stdtrit

    n, mean, spread = len(given), float(given.mean()), float(given.std(ddof=1))
    error = spread / n**0.5
    half = float(stdtrit(n - 1, 1 - alpha / 2)) * error
    p = 2 * float(stdtr(n - 1, -abs(mean) / error)) if error else float(mean == 0)
    return Difference(
        blocks=n,
        value=mean,
        spread=spread,
        low=mean - half,
        high=mean + half,
        level=1 - alpha,
        p=p,
        adjusted=p if adjusted is None else adjusted,
    )


def family(differences: Sequence[ArrayLike]) -> list[Difference]:
    """Computes the differences of a family of tests, with intervals that agree with Holm's procedure.

    The difference of the smallest p has an interval of level 1 - alpha / m. While one excludes 0, the next has one of
    1 - alpha / (m - 1), and so on; all after the first that contains 0 have the level of that one. So an interval
    excludes 0 exactly where Holm's procedure rejects no difference.

    Args:
        differences: (n,) for each test; numbers of blocks may differ.

    Raises:
        ValueError: Fewer than two blocks.
    """
    alone = [difference(values) for values in differences]
    adjusted = holm([one.p for one in alone])
    found, left, going = list(alone), len(alone), True
    for index in sorted(range(len(alone)), key=lambda i: alone[i].p):
        found[index] = difference(differences[index], ALPHA / left, adjusted[index])
        going = going and adjusted[index] < ALPHA
        left -= going
    return found


def verdict(found: Difference, smallest: float = SMALLEST) -> Verdict:
    """Applies the rule of the plan to a difference of the population and self-play.

    Args:
        found: With its interval.
        smallest: Smallest difference of interest.
    """
    if found.low > 0:
        return "supported"
    return "refuted" if found.high < smallest else "undecided"


def wording(found: Difference, smallest: float = SMALLEST) -> str:
    """Returns the sentence that the plan has for a verdict."""
    said = verdict(found, smallest)
    if said == "supported":
        if found.high < smallest:
            return (
                f"Supported, but the difference is smaller than {smallest:g}, the smallest of interest: the population "
                "cooperates better with these partners, by an amount that does not matter."
            )
        return "Supported: the population cooperates better with these partners than self-play of the same length."
    if said == "refuted":
        if found.high < 0:
            return "Refuted: self-play of the same length cooperates better with these partners than the population."
        return f"Refuted: a difference of {smallest:g} or more in favour of the population is excluded."
    return f"Undecided: neither no difference nor one of {smallest:g} is excluded."


def paired(first: Sequence[float], second: Sequence[float]) -> NDArray[Any]:
    """Returns (n,) differences per block, the first less the second.

    Raises:
        ValueError: The numbers of blocks differ.
    """
    if len(first) != len(second):
        raise ValueError(f"{len(first)} and {len(second)} blocks; give the same blocks of both")
    return np.asarray(first, np.float64) - np.asarray(second, np.float64)
