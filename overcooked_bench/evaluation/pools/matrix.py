"""Summarises a matrix of returns: how well agents play with themselves, and with one another.

What varies is an agent, not a pair and not an episode: the pairs of a matrix share agents, so whole agents are drawn.

Axes: P agents, U independent units (lineages), D draws.
"""

from collections.abc import Sequence
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.estimate import Estimate, student

FEWEST_UNITS: Final = 3
"""With fewer independent agents nothing can be said about others of their kind."""
FEWEST_OF_RATIO: Final = 10
"""With fewer, a ratio has no interval: four that form unequal cliques would be covered in 0.77 of the cases."""
_DRAWS: Final = 2000


class Agreement(NamedTuple):
    """Self-play against cross-play.

    Attributes:
        self_play: Mean return of agents with themselves, the diagonal.
        cross_play: Mean return of pairs of different lineages, both seats.
        ratio: Cross-play by self-play: 1 where partners do not matter, 0 where every agent has conventions of its own.
            None where self-play brings nothing.
        units: U, independent agents.
    """

    self_play: Estimate
    cross_play: Estimate
    ratio: Estimate | None
    units: int


def agreement(means: ArrayLike, lineages: Sequence[str]) -> Agreement:
    """Sums a matrix up, with 95 % intervals for other agents of the same kind.

    An interval is Student's t with U - 1 degrees of freedom times the standard deviation over draws of U units with
    replacement, rows and columns together, pairs of one lineage left out. In simulations with additive agents, cliques
    and agents that agree at random it covers the truth in 0.88 to 1.0 of the cases from six units on. A ratio has one
    from `FEWEST_OF_RATIO` units on.

    Args:
        means: (P, P), row: the agent on seat 0, column: the one on seat 1.
        lineages: P, equal for agents that are tied to each other.

    Raises:
        ValueError: Fewer than two lineages: no pair of strangers.
    """
    matrix = np.asarray(means, np.float64)
    names, unit = np.unique(np.asarray(lineages), return_inverse=True)
    if matrix.shape != (len(unit), len(unit)):
        raise ValueError(f"a matrix of the shape {matrix.shape} for {len(unit)} agents")
    if len(names) < 2:
        raise ValueError("all agents are of one lineage; cross-play is between strangers, of two lineages at least")
    strangers = unit[:, None] != unit[None, :]
    own = _estimates(np.ones((1, len(unit))), matrix, strangers)[:, 0]
    units = len(names)
    half: NDArray[Any] = np.full(3, np.nan)
    if units >= FEWEST_UNITS:
        counts = np.random.default_rng(0).multinomial(units, np.full(units, 1 / units), _DRAWS)
        counts = counts[(counts > 0).sum(axis=1) > 1]  # one unit alone makes no pair
        drawn = _estimates(counts[:, unit].astype(np.float64), matrix, strangers)
        half = student(units - 1) * drawn.std(axis=1) * (units / (units - 1)) ** 0.5
    if units < FEWEST_OF_RATIO:
        half[2] = np.nan
    self_play, cross_play, ratio = (_interval(*pair) for pair in zip(own, half, strict=True))
    return Agreement(self_play, cross_play, ratio if own[0] > 0 else None, units)


def _estimates(weights: NDArray[np.float64], matrix: NDArray[np.float64], strangers: NDArray[np.bool_]) -> NDArray[Any]:
    """Returns self-play, cross-play and their ratio for weighted agents.

    Args:
        weights: (D, P).
        matrix: (P, P).
        strangers: (P, P), which pairs count as cross-play.

    Returns:
        (3, D); a ratio without self-play is 0.
    """
    self_play = weights @ np.diag(matrix) / weights.sum(axis=1)
    cross_play = ((weights @ (matrix * strangers)) * weights).sum(axis=1)
    cross_play /= ((weights @ strangers.astype(np.float64)) * weights).sum(axis=1)
    ratio = np.divide(cross_play, self_play, out=np.zeros_like(cross_play), where=self_play > 0)
    return np.stack([self_play, cross_play, ratio])


def _interval(value: float, half: float) -> Estimate:
    if np.isnan(half):
        return Estimate(float(value))
    return Estimate(float(value), float(max(0.0, value - half)), float(value + half))
