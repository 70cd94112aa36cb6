"""Permutation tests of a difference, which assume no shape of its distribution, and Holm's adjustment for several.

Two methods are tested over their training seeds, two agents over the partners that both met. Neither test draws on the
other's unit: episodes and partners of one training run share its luck, and are no independent evidence on a method.

Axes: S training seeds of each method, U units that two agents share, C relabellings.
"""

from collections.abc import Sequence
from functools import cache
from itertools import combinations
from math import comb
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

MOST_EXACT: Final = 50_000
"""Relabellings that are all tried; of more, some are drawn."""
DRAWS: Final = 9_999

_SLACK: Final = 1e-9
"""Sums that differ by so small a part of the greatest number are the same sum."""


def over_seeds(first: ArrayLike, second: ArrayLike) -> float:
    """Returns the two-sided p of the difference of two methods: the share of relabelled seeds that differ as much.

    Under the hypothesis that the two methods make the same distribution of scores, any S of the 2 S scores were as
    likely to be the first method's: all runs meet the same partners from the same start states, and given these, runs
    are independent. So the level holds exactly, whatever the shape, two camps of seeds included. Where the methods have
    equal means and different spreads, it holds for equal S as S grows (Romano 1990), and with unequal S it does not;
    that is why equal numbers are enforced.

    Two schemes that look natural are not used. Swapping within pairs (seed 0 with seed 0, and so on) is valid, but its
    pairs have nothing in common, and there are 2^S swaps instead of C(2 S, S) choices: five seeds could not be
    significant. Swapping partners or episodes is not valid for methods: a run's luck is common to all its partners.

    Args:
        first: (S,) the score of each training seed of one method.
        second: (S,) the other's.

    Raises:
        ValueError: The numbers of seeds differ.

    Source: Fisher 1935, "The Design of Experiments"; Pitman 1937, "Significance tests which may be applied to samples
    from any populations"; Romano 1990, "On the behavior of randomization tests without a group invariance assumption";
    Phipson and Smyth 2010, "Permutation p-values should never be zero" (for drawn relabellings).
    """
    seeds = len(np.asarray(first))
    pooled = np.concatenate([np.asarray(first, np.float64), np.asarray(second, np.float64)])
    if len(pooled) != 2 * seeds:
        raise ValueError(f"{seeds} training seeds and {len(pooled) - seeds}; give equal numbers")
    pooled -= pooled.mean()
    if comb(2 * seeds, seeds) <= MOST_EXACT:
        return _share(pooled[_choices(seeds)].sum(axis=1), pooled[:seeds], drawn=False)
    shuffled = np.random.default_rng(0).permuted(np.tile(pooled, (DRAWS, 1)), axis=1)
    return _share(shuffled[:, :seeds].sum(axis=1), pooled[:seeds], drawn=True)


def smallest_p(seeds: int) -> float:
    """Returns the smallest p that `over_seeds` can have: .33 for 2 seeds, .10 for 3, .029 for 4, .008 for 5."""
    choices = comb(2 * seeds, seeds)
    return 2 / choices if choices <= MOST_EXACT else 1 / (DRAWS + 1)


def over_units(parts: ArrayLike) -> float:
    """Returns the two-sided p of the difference of two agents: the share of sign flips that differ as much.

    Both met the same units. Under the hypothesis that neither is better, a unit is as likely to favour the one as the
    other by the same amount, so each sign was as likely; units are independent, and start states, drawn for each
    partner, are flipped with it. The level is exact if the differences are symmetric around 0, and holds for many units
    if their mean is 0.

    Args:
        parts: (U,) what each unit adds to the difference: a partner on a layout, by its share.

    Source: Fisher 1935; Romano 1990.
    """
    given = np.asarray(parts, np.float64)
    if 2 ** len(given) <= MOST_EXACT:
        signs = 1.0 - 2 * (np.arange(2 ** len(given))[:, None] >> np.arange(len(given)) & 1)
        return _share(signs @ given, given, drawn=False)
    signs = 2.0 * np.random.default_rng(0).integers(0, 2, (DRAWS, len(given)), np.int8) - 1
    return _share(signs @ given, given, drawn=True)


def improvement(first: ArrayLike, second: ArrayLike) -> float:
    """Returns the probability that a training seed of the first method beats one of the second; ties count half.

    Args:
        first: (S,) the score of each training seed.
        second: (S,) the other's.

    Source: Agarwal et al. 2021, "Deep Reinforcement Learning at the Edge of the Statistical Precipice".
    """
    differences = np.subtract.outer(np.asarray(first, np.float64), np.asarray(second, np.float64))
    return float(((differences > 0) + 0.5 * (differences == 0)).mean())


def holm(p: Sequence[float]) -> list[float]:
    """Adjusts p-values so that all hypotheses at or below .05 can be rejected with an error of 5 % for all together.

    Source: Holm 1979, "A simple sequentially rejective multiple test procedure".
    """
    adjusted, least = [0.0] * len(p), 0.0
    for rank, index in enumerate(sorted(range(len(p)), key=lambda i: p[i])):
        least = max(least, min(1.0, (len(p) - rank) * p[index]))
        adjusted[index] = least
    return adjusted


def _share(sums: NDArray[np.float64], observed: NDArray[np.float64], drawn: bool) -> float:
    """Returns the share of sums as far from 0 as the observed numbers' one, which counts among the drawn ones."""
    least = abs(float(observed.sum())) - _SLACK * float(np.abs(observed).max())
    return (int((np.abs(sums) >= least).sum()) + drawn) / (len(sums) + drawn)


@cache
def _choices(seeds: int) -> NDArray[Any]:
    """Returns (C, S) indices: every choice of half of 2 S scores."""
    return np.array(list(combinations(range(2 * seeds), seeds)), np.int64)
