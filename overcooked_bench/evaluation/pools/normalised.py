"""The normalised score N of a meeting: 0 is the better of `stay` and `random`, 1 the best known responder.

Axes: A agents, P partners, E episodes from each seat, K = 2 seats of the agent, S sides of the floor.
"""

from collections import defaultdict
from collections.abc import Sequence
from typing import Protocol

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.errors import WrongUse


class Reach(Protocol):
    """What can be reached with a partner from one side: a `Bound` of a manifest, or what a score keeps of it."""

    @property
    def side(self) -> int:
        """Region that the other agent starts in."""

    @property
    def floor(self) -> float:
        """Points per episode that mean 0."""

    @property
    def ceiling(self) -> float:
        """Points per episode that mean 1."""


class Known(Protocol):
    """What is known about a partner: an `Entry` of a manifest, or what a score keeps of it."""

    @property
    def name(self) -> str:
        """Its name."""

    @property
    def stratum(self) -> str:
        """Its origin."""

    @property
    def weight(self) -> float | None:
        """Its share of its stratum; None if all weigh the same."""

    @property
    def bounds(self) -> Sequence[Reach] | None:
        """What can be reached, by side; None if nobody knows."""


def side_means(returns: ArrayLike, sides: ArrayLike, count: int | None = None) -> NDArray[np.float64]:
    """Averages returns over the episodes that an agent starts on a side, both seats together.

    Args:
        returns: (A, P, E, K) points per episode.
        sides: (A, P, E, K) int, the side that the agent starts on, from 0.
        count: S, by default one more than the largest side.

    Returns:
        (A, P, S); NaN where an agent never starts on that side.
    """
    y, side = np.asarray(returns, np.float64), np.asarray(sides, np.int64)
    there = side[..., None] == np.arange(int(side.max()) + 1 if count is None else count)
    number = there.sum(axis=(2, 3))
    total = (y[..., None] * there).sum(axis=(2, 3))
    return np.asarray(np.divide(total, number, out=np.full(total.shape, np.nan), where=number > 0))


def normalised(means: ArrayLike, partners: Sequence[Known]) -> NDArray[np.float64]:
    """Computes N of each agent with each partner from each side: (mean - floor) / (ceiling - floor), unclipped.

    Args:
        means: (A, P, S) points per episode, of `side_means`.
        partners: P entries with bounds.

    Returns:
        (A, P, S); NaN where the mean is.

    Raises:
        WrongUse: A partner has no bounds for a side that an agent started on, or its ceiling is not above its floor.
    """
    given = np.asarray(means, np.float64)
    found = np.full(given.shape, np.nan)
    for index, entry in enumerate(partners):
        bounds = {bound.side: bound for bound in entry.bounds or ()}
        for side in np.flatnonzero(np.isfinite(given[:, index]).any(axis=0)).tolist():
            if side not in bounds:
                raise WrongUse(
                    f"{entry.name} has no floor and ceiling for side {side}; score with a pool whose "
                    "manifest holds the bounds of all its partners, such as v1"
                )
            floor, ceiling = bounds[side].floor, bounds[side].ceiling
            if ceiling <= floor:
                raise WrongUse(
                    f"{entry.name}, side {side}: the ceiling of {ceiling:g} points is not above the "
                    f"floor of {floor:g}; leave this partner out"
                )
            found[:, index, side] = (given[:, index, side] - floor) / (ceiling - floor)
    return found


def partner_shares(partners: Sequence[Known]) -> NDArray[np.float64]:
    """Returns each partner's share of the whole score: strata have the same share, and divide it by `Entry.weight`.

    Where a stratum's partners have no weights, or are only such as have the weight 0, they weigh the same.

    Args:
        partners: P entries of one layout; floors have no place among them.

    Returns:
        (P,) with the sum 1.

    Raises:
        WrongUse: Some partners of a stratum have a weight and others have none.
    """
    strata: dict[str, list[int]] = defaultdict(list)
    for index, entry in enumerate(partners):
        strata[entry.stratum].append(index)
    shares = np.empty(len(partners))
    for stratum, members in strata.items():
        known = [weight for index in members if (weight := partners[index].weight) is not None]
        if known and len(known) < len(members):
            raise WrongUse(
                f"{len(known)} of {len(members)} partners of the stratum {stratum!r} have a weight; all must"
            )
        weights = np.array(known if sum(known) > 0 else [1.0] * len(members))
        shares[members] = weights / weights.sum() / len(strata)
    return shares


def weighted_mean(values: ArrayLike, shares: ArrayLike) -> NDArray[np.float64]:
    """Computes the score N of each agent: the mean over partners by their shares, a partner's sides equally.

    Args:
        values: (A, P, S) of `normalised`; a side that is NaN is left out of its partner's mean.
        shares: (P,) of `partner_shares`; partners of share 0 are left out.

    Returns:
        (A,)

    Raises:
        ValueError: An agent did not meet a partner that has a share.
    """
    given, weights = np.asarray(values, np.float64), np.asarray(shares, np.float64)
    used = weights > 0
    known = np.isfinite(given[:, used])
    if not known.any(axis=2).all():
        raise ValueError("an agent has no episode with a partner that counts; let every agent meet every partner")
    of_partner = np.where(known, given[:, used], 0.0).sum(axis=2) / known.sum(axis=2)
    return np.asarray(of_partner @ weights[used] / weights[used].sum())
