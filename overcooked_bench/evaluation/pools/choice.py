"""Chooses partners of a pool: as many of each kind as wanted, that do what others do not, and are as diverse as can be.

Axes: N candidates, V values of axes of conventions, M combinations of values.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

COVERED_BY: Final = 2
"""Partners in which each value of a convention occurs."""
LARGEST_SHARE: Final = 3
"""No combination of values occurs in more than one in so many partners."""
_DIGITS: Final = 9  # of a mean similarity; those beyond depend on the order of sums


class Candidate(NamedTuple):
    """Somebody who may become a partner.

    Attributes:
        name: What messages call it.
        quota: Which quota it counts to.
        lineage: At most one of a lineage is chosen.
        convention: Axis -> value, of `read_convention`.
        eligible: Whether it may be chosen.
        successful: Whether the values of its convention must occur among the chosen ones.
    """

    name: str
    quota: str
    lineage: str
    convention: Mapping[str, str]
    eligible: bool = True
    successful: bool = True


class Choice(NamedTuple):
    """What was chosen.

    Attributes:
        chosen: Indices of the candidates, ascending.
        unmet: What could not be satisfied, in sentences; empty if everything was.
    """

    chosen: tuple[int, ...]
    unmet: tuple[str, ...]


def choose_partners(candidates: Sequence[Candidate], similarity: ArrayLike, quotas: Mapping[str, int]) -> Choice:
    """Chooses partners under quotas, one at a time, and then exchanges single ones while that makes the choice better.

    Of two choices the better one has fewer missing values of conventions; then fewer partners beyond the third that one
    combination may have; then a smaller mean similarity, which is a larger effective number. Every value that an
    eligible and successful candidate uses is wanted in two partners, or in one if only one eligible candidate has it.
    The result depends on nothing but the arguments; of equally good candidates the first one is taken.

    Args:
        candidates: N, with those that are partners in any case: their quota is their number.
        similarity: (N, N) of `similarity`.
        quotas: Quota -> how many.

    Raises:
        ValueError: A similarity of another shape, or a quota that is negative or that no candidate counts to.
    """
    s = np.asarray(similarity, np.float64)
    if s.shape != (len(candidates), len(candidates)):
        raise ValueError(f"similarity has the shape {s.shape} for {len(candidates)} candidates")
    names = {candidate.quota for candidate in candidates}
    for quota, wanted in quotas.items():
        if wanted < 0:
            raise ValueError(f"quota {quota!r} is {wanted}; give a number from 0")
        if wanted and quota not in names:
            raise ValueError(
                f"quota {quota!r} is {wanted}, and no candidate counts to it; there are {', '.join(sorted(names))}"
            )
    search = _Search(candidates, s, quotas)
    search.fill()
    search.exchange()
    return Choice(tuple(sorted(search.chosen)), tuple(search.unmet()))


class _Search:
    """A choice that is being made."""

    def __init__(self, candidates: Sequence[Candidate], s: NDArray[np.float64], quotas: Mapping[str, int]) -> None:
        self.chosen: list[int] = []
        self._candidates, self._s, self._quotas = candidates, s, quotas
        self._able = [i for i, one in enumerate(candidates) if one.eligible and quotas.get(one.quota, 0) > 0]
        items = [set(one.convention.items()) for one in candidates]
        self._values = sorted(set().union(*(items[i] for i in self._able if candidates[i].successful)))
        self._combinations = sorted({tuple(sorted(pairs)) for pairs in items if pairs})
        self._has = _table([[value in pairs for value in self._values] for pairs in items])
        self._does = _table([[tuple(sorted(pairs)) == whole for whole in self._combinations] for pairs in items])
        self._wanted = np.minimum(COVERED_BY, self._has[self._able].sum(axis=0))
        self._size = sum(min(wanted, self._spare(quota)) for quota, wanted in quotas.items())

    def fill(self) -> None:
        """Takes one candidate after the other, first those of quotas that have none to spare."""
        scarce = {quota for quota, wanted in self._quotas.items() if self._spare(quota) <= wanted}
        for first in (True, False):
            some = [i for i in self._able if (self._candidates[i].quota in scarce) == first]
            while free := [i for i in some if self._fits(i)]:
                costs = {i: self._cost([*self.chosen, i]) for i in free}
                self.chosen.append(
                    min(free, key=lambda i: (*costs[i], round(float(self._s[i, self._able].mean()), _DIGITS), i))
                )

    def exchange(self) -> None:
        """Exchanges a chosen candidate for another one of its quota, the best such exchange first, while it helps."""
        now = self._cost(self.chosen) if self.chosen else None
        while now:
            better = [(self._cost(other), other) for other in self._others()]
            best = min(better, key=lambda pair: pair[0], default=None)
            if best is None or best[0] >= now:
                return
            now, self.chosen = best

    def _others(self) -> Iterator[list[int]]:
        """Yields every choice that differs by one exchange within a quota."""
        for place, out in enumerate(self.chosen):
            rest = self.chosen[:place] + self.chosen[place + 1 :]
            taken = {self._candidates[i].lineage for i in rest}
            for i in self._able:
                one = self._candidates[i]
                if i != out and one.quota == self._candidates[out].quota and one.lineage not in taken:
                    yield [*rest, i]

    def unmet(self) -> list[str]:
        """Says what could not be satisfied."""
        said = []
        for quota, wanted in self._quotas.items():
            taken = sum(self._candidates[i].quota == quota for i in self.chosen)
            if taken < wanted:
                said.append(
                    f"{quota}: {taken} of {wanted} partners; too few candidates are eligible, or they share lineages"
                )
        for (axis, value), having, able in zip(
            self._values, self._has[self.chosen].sum(axis=0), self._has[self._able].sum(axis=0), strict=True
        ):
            if having < COVERED_BY:
                said.append(f"{axis}={value}: {having} of {COVERED_BY} partners; {able} eligible candidates have it")
        for whole, times in zip(self._combinations, self._does[self.chosen].sum(axis=0), strict=True):
            if times > self._most:
                name = ", ".join(f"{axis}={value}" for axis, value in whole)
                said.append(f"{name}: {times} of {len(self.chosen)} partners, more than {self._most}")
        return said

    @property
    def _most(self) -> int:
        """How many partners may have one combination."""
        return self._size // LARGEST_SHARE

    def _spare(self, quota: str) -> int:
        """How many lineages could fill a quota."""
        return len({self._candidates[i].lineage for i in self._able if self._candidates[i].quota == quota})

    def _fits(self, i: int) -> bool:
        """Whether a candidate can be added."""
        one, taken = self._candidates[i], [self._candidates[j] for j in self.chosen]
        same = sum(other.quota == one.quota for other in taken)
        return same < self._quotas[one.quota] and all(other.lineage != one.lineage for other in taken)

    def _cost(self, chosen: list[int]) -> tuple[int, int, float]:
        """Returns missing values, partners beyond the share of a combination, and the mean similarity."""
        missing = np.maximum(self._wanted - self._has[chosen].sum(axis=0), 0).sum()
        beyond = np.maximum(self._does[chosen].sum(axis=0) - self._most, 0).sum()
        return int(missing), int(beyond), round(float(self._s[np.ix_(chosen, chosen)].mean()), _DIGITS)


def _table(rows: list[list[bool]]) -> NDArray[np.int64]:
    return np.array(rows, np.int64).reshape(len(rows), -1)
