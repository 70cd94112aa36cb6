"""Which rows of a table the data separate, and in a form that stays short however many there are.

Methods are tested over training seeds, single agents over the partners that they all met.
"""

from collections.abc import Mapping, Sequence
from itertools import combinations
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.comparing.letters import letters_of
from overcooked_bench.evaluation.comparing.permutation import (
    DRAWS,
    MOST_EXACT,
    holm,
    over_seeds,
    over_units,
    smallest_p,
)

LEVEL: Final = 0.05
"""Two rows are separated if their adjusted p is this or less."""

MOST_LETTERS: Final = 12
"""Of more rows, letters would be long and say little; places are shown alone."""


_LEAST: Final = 1e-18
"""Least variance, of scores that are all the same."""


class Mark(NamedTuple):
    """Where a row stands among those of its table.

    Attributes:
        letters: Two that share one are not separated; empty if there are more than `MOST_LETTERS`.
        first: Its highest possible place: one below all that are separated from it and higher.
        last: Its lowest possible place.
    """

    letters: str
    first: int
    last: int

    @property
    def places(self) -> str:
        """Both places as a text."""
        return str(self.first) if self.first == self.last else f"{self.first}-{self.last}"


class Groups(NamedTuple):
    """What the data separate.

    Attributes:
        marks: Row -> where it stands.
        separated: Pairs that are separated.
        pairs: All pairs.
        permuted: Whether they were tested by permutations, or by Student's t because there are too many of them.
    """

    marks: Mapping[str, Mark]
    separated: int
    pairs: int
    permuted: bool


def separate(runs: Mapping[str, Sequence[float]]) -> Groups:
    """Tests every two methods over training seeds, adjusted by Holm for all pairs.

    The permutation test, which assumes no shape of the distribution, has a smallest p: .008 with five seeds. Of more
    than four methods it could not separate two, however far apart they are; the fewest seeds decide for all pairs.
    Then Welch's t is used, which assumes what the intervals of the page assume, that scores of training seeds are
    normally distributed.

    Args:
        runs: Method -> the score of each of its training seeds, two or more; the method with the highest score first.
    """
    names, pairs = _paired(runs)
    scores = [np.asarray(runs[name], np.float64) for name in names]
    permuted = smallest_p(min(map(len, scores), default=0)) * len(pairs) <= LEVEL
    p = [_permuted(scores[one], scores[other]) for one, other in pairs] if permuted else _welch(scores, pairs)
    return _grouped(names, pairs, p, permuted)


def separate_agents(parts: Mapping[str, Mapping[tuple[str, str], float]]) -> Groups:
    """Tests every two agents over the partners that all of them met, adjusted by Holm for all pairs.

    The test flips signs of differences. Of more than 32 agents it could not separate two; then the paired t is used.

    Args:
        parts: Agent -> what each partner, by layout and name, adds to its score; the agent with the highest score
            first. Agents that met other partners than the first one have no place.
    """
    met = next(iter(parts.values()), {}).keys()
    runs = {name: [found[key] for key in met] for name, found in parts.items() if found.keys() == met and len(met) > 1}
    names, pairs = _paired(runs)
    scores = np.array(list(runs.values()), np.float64)
    permuted = max(2 / 2 ** len(met), 1 / (DRAWS + 1) if 2 ** len(met) > MOST_EXACT else 0) * len(pairs) <= LEVEL
    p = [over_units(scores[one] - scores[other]) for one, other in pairs] if permuted else _paired_t(scores, pairs)
    return _grouped(names, pairs, p, permuted)


def _paired(runs: Mapping[str, object]) -> tuple[list[str], list[tuple[int, int]]]:
    return list(runs), list(combinations(range(len(runs)), 2))


def _grouped(names: Sequence[str], pairs: Sequence[tuple[int, int]], p: Sequence[float], permuted: bool) -> Groups:
    apart = [pair for pair, adjusted in zip(pairs, holm(p), strict=True) if adjusted <= LEVEL]
    above, below = [0] * len(names), [0] * len(names)
    for one, other in apart:
        below[one] += 1
        above[other] += 1
    letters = dict.fromkeys(names, "")
    if len(names) <= MOST_LETTERS:
        letters = letters_of(names, {frozenset((names[one], names[other])) for one, other in apart})
    marks = {name: Mark(letters[name], 1 + above[index], len(names) - below[index]) for index, name in enumerate(names)}
    return Groups(marks, len(apart), len(pairs), permuted)


def _permuted(one: NDArray[np.float64], other: NDArray[np.float64]) -> float:
    seeds = min(len(one), len(other))
    return over_seeds(one[:seeds], other[:seeds])


def _welch(scores: Sequence[NDArray[np.float64]], pairs: Sequence[tuple[int, int]]) -> list[float]:
    """Returns the two-sided p of Welch's t of each pair.

    No method's variance counts less than the median method's: among hundreds of methods, a few have seeds that agree by
    luck, and these would be separated from all others.

    Source: Welch 1947, "The generalization of `Student's' problem when several different population variances are
    involved".
    """
    from scipy.stats import t

    variances = np.array([one.var(ddof=1) for one in scores])
    counts = np.array([len(one) for one in scores])
    errors = np.maximum(variances, max(_LEAST, np.median(variances))) / counts
    means = np.array([one.mean() for one in scores])
    one, other = np.array(pairs).T
    error = errors[one] + errors[other]
    freedom = error**2 / (errors[one] ** 2 / (counts[one] - 1) + errors[other] ** 2 / (counts[other] - 1))
    found: list[float] = (2 * t.sf(np.abs(means[one] - means[other]) / np.sqrt(error), freedom)).tolist()
    return found


def _paired_t(scores: NDArray[np.float64], pairs: Sequence[tuple[int, int]]) -> list[float]:
    """Returns the two-sided p of the paired t of each pair, from sums and products of all at once."""
    from scipy.stats import t

    count, sums, products = scores.shape[1], scores.sum(axis=1), scores @ scores.T
    one, other = np.array(pairs).T
    total = sums[one] - sums[other]
    squares = np.diag(products)[one] + np.diag(products)[other] - 2 * products[one, other]
    variance = np.maximum((squares - total**2 / count) / (count - 1), _LEAST)
    found: list[float] = (2 * t.sf(np.abs(total) / np.sqrt(count * variance), count - 1)).tolist()
    return found
