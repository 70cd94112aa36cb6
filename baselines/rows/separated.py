"""Which methods the data separate: every two of them by a permutation test over training seeds, adjusted by Holm."""

from collections.abc import Sequence
from itertools import combinations

import msgspec
import numpy as np

from overcooked_bench.estimate import Estimate, welch_interval
from overcooked_bench.evaluation.comparing.letters import letters_of
from overcooked_bench.evaluation.comparing.permutation import holm, improvement, over_seeds, smallest_p
from overcooked_bench.evaluation.estimators import FEWEST_RUNS

from .records import EntryRecord

LEVEL = 0.05
"""Two methods are separated if their adjusted p is this or less."""


class Pair(msgspec.Struct, frozen=True):
    """Two methods.

    Attributes:
        first: Name of the one with the higher N.
        second: Name of the other one.
        seeds: Training seeds of each that are compared: all that both have, the first ones of the one that has more.
        difference: N of the first minus N of the second over these, with Welch's interval.
        better: Probability that a training seed of the first beats one of the second.
        p: Of the permutation test.
        adjusted: The same by Holm over all pairs.
    """

    first: str
    second: str
    seeds: int
    difference: Estimate
    better: float
    p: float
    adjusted: float

    @property
    def separated(self) -> bool:
        """Whether the data separate the two."""
        return self.adjusted <= LEVEL


def methods(entries: Sequence[EntryRecord]) -> list[EntryRecord]:
    """Lists those with so many training seeds that they count as a method, and with an N on all layouts."""
    return [one for one in entries if one.n is not None and len(one.by_seed) >= FEWEST_RUNS]


def pairs(entries: Sequence[EntryRecord]) -> list[Pair]:
    """Compares every two methods by N.

    Numbers of training seeds are equal in every pair, since the test needs that; which ones are left out of the method
    that has more is decided by their numbers, not by what they reached.
    """
    found = []
    for one, other in combinations(methods(entries), 2):
        seeds = min(len(one.by_seed), len(other.by_seed))
        mine, theirs = one.by_seed[:seeds], other.by_seed[:seeds]
        p = over_seeds(mine, theirs)
        better = improvement(mine, theirs)
        found.append(Pair(one.name, other.name, seeds, welch_interval(mine, theirs), better, p, p))
    adjusted = holm([pair.p for pair in found])
    return [msgspec.structs.replace(pair, adjusted=p) for pair, p in zip(found, adjusted, strict=True)]


def letters(entries: Sequence[EntryRecord], compared: Sequence[Pair]) -> dict[str, str]:
    """Returns the letters of each method: two that share one are not separated, two that share none are.

    Args:
        entries: All, the highest N first.
        compared: What `pairs` returns for them.

    Returns:
        Name -> letters, in the order of N.
    """
    names = [one.name for one in methods(entries)]
    apart = {frozenset((pair.first, pair.second)) for pair in compared if pair.separated}
    return letters_of(names, apart)


def fewest_seeds(count: int) -> int:
    """Returns the number of training seeds from which on one pair among `count` can be separated at all."""
    return next(seeds for seeds in range(2, 1000) if smallest_p(seeds) * count <= LEVEL)


def difference(mine: EntryRecord, other: EntryRecord, layout: str | None = None) -> tuple[Estimate, float] | None:
    """Returns the difference of two entries' N with its p, on a layout or over all; None if there are too few seeds."""
    runs = [_runs(one, layout) for one in (mine, other)]
    seeds = min(map(len, runs))
    if seeds < 2:
        return None
    first, second = (np.asarray(one[:seeds]) for one in runs)
    return welch_interval(first, second), over_seeds(first, second)


def _runs(entry: EntryRecord, layout: str | None) -> tuple[float, ...]:
    if layout is None:
        return entry.by_seed
    return next((one.by_seed for one in entry.layouts if one.layout == layout), ())
