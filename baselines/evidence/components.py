"""How much of the variance of returns comes from partner, seat, side, start, and the entrant's training.

The model is y = mean + recipe + training seed + partner + recipe x partner + training seed x partner + side + seat +
start + noise. Entrants (nested in recipes) and partners are random and crossed. Sides and seats are two each, all of
them in the data; their variance is over these two, whatever they interact with. A start state is common to all entrants
that face a partner; noise is the rest. Each component is a difference of mean products of pairs of returns: pairs that
share an effect have its variance in their product, others do not. Nothing has to be balanced or normal, and estimates
may be below zero.

Axes: A entrants, P partners, E episodes, K = 2 seats of the entrant.

Source: Koch 1967, "A general approach to the estimation of variance components".
"""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

COMPONENTS: Final = (
    "partner",
    "recipe",
    "training seed",
    "recipe x partner",
    "training seed x partner",
    "side",
    "seat",
    "start",
    "noise",
)


def components(returns: ArrayLike, sides: ArrayLike, recipes: Sequence[str]) -> dict[str, float]:
    """Estimates the variance components of returns.

    Args:
        returns: (A, P, E, K) points per episode, E >= 2.
        sides: (A, P, E, K) int, the side that the entrant starts on.
        recipes: A, equal for entrants that differ in their training seed alone.

    Returns:
        By the names of `COMPONENTS`, in squared points; NaN where the data cannot show one, which is then part of the
        noise: side where there is one side, seat where episodes are too few to have both seats on a side repeatedly,
        training seed where no recipe has two entrants, recipe where there is one.

    Raises:
        ValueError: Fewer than two episodes, or entrants that did not get the same starts.
    """
    y, side = np.asarray(returns, np.float64), np.asarray(sides, np.int64)
    if y.shape[2] < 2:
        raise ValueError(f"{y.shape[2]} episodes per seat; variance components need two at least")
    if (side != side[:1]).any():
        raise ValueError("entrants start on different sides in the same episode; play them with the same starts")
    y = y - y.mean()
    pair, between = _between(y.mean(axis=3), np.asarray(recipes))
    found = between | _within(y.reshape(*y.shape[:2], -1), side[0].reshape(y.shape[1], -1), y.shape[3])
    within = float((y**2).mean()) - pair
    found["noise"] = within - float(np.nansum([found[name] for name in ("side", "seat", "start")]))
    return {name: found[name] for name in COMPONENTS}


def shares(found: dict[str, float]) -> dict[str, float]:
    """Returns each component's share of the sum, estimates below zero as zero; NaN stays."""
    least = {name: max(0.0, value) if np.isfinite(value) else value for name, value in found.items()}
    total = float(np.nansum([*least.values()]))
    return {name: value / total if total else np.nan for name, value in least.items()}


def _between(y: NDArray[np.float64], recipes: NDArray[Any]) -> tuple[float, dict[str, float]]:
    """Estimates what differs between pairs of entrant and partner.

    Args:
        y: (A, P, E) means of both seats.
        recipes: (A,).

    Returns:
        The mean square of a pair's expected return, and the components.
    """
    _, partners, episodes = y.shape
    same_partner = _across_episodes(np.moveaxis(y, 1, 0)).sum(axis=0)
    other_partner = _across_episodes(y.sum(axis=1)[None])[0] - same_partner
    same_partner /= partners * episodes * (episodes - 1)
    other_partner /= partners * (partners - 1) * episodes * (episodes - 1)
    itself = np.eye(len(recipes), dtype=bool)
    kin = (recipes[:, None] == recipes[None, :]) & ~itself
    others = ~kin & ~itself

    def means(pairs: NDArray[np.bool_]) -> tuple[float, float]:
        if not pairs.any():
            return np.nan, np.nan
        return float(same_partner[pairs].mean()), float(other_partner[pairs].mean())

    (pair, seed), (kin_with, kin_without), (with_, without) = means(itself), means(kin), means(others)
    return pair, {
        "partner": with_ - without,
        "recipe": kin_without - without,
        "training seed": seed - kin_without,
        "recipe x partner": kin_with - kin_without - with_ + without,
        "training seed x partner": pair - seed - kin_with + kin_without,
    }


def _across_episodes(y: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns (..., A, A) sums of products of (..., A, E) returns, over pairs of different episodes."""
    total = y.sum(axis=-1)
    return np.asarray(total[..., :, None] * total[..., None, :] - y @ np.swapaxes(y, -1, -2))


def _within(y: NDArray[np.float64], side: NDArray[np.int64], seats: int) -> dict[str, float]:
    """Estimates what differs between episodes of one pair of entrant and partner.

    Args:
        y: (A, P, I), I = E * K.
        side: (P, I).
        seats: K.
    """
    agents, _, episodes = y.shape
    own = np.einsum("api,apj->pij", y, y)
    everyone = y.sum(axis=0)
    across = (everyone[:, :, None] * everyone[:, None, :] - own) / (agents * max(1, agents - 1))
    episode, seat = np.divmod(np.arange(episodes), seats)
    other = np.broadcast_to(episode[:, None] != episode[None, :], own.shape)
    same_seat = np.broadcast_to(seat[:, None] == seat[None, :], own.shape)
    same_side = side[:, :, None] == side[:, None, :]
    found = _sides_and_seats(own / agents, other, side, same_seat)
    again = other & same_side & same_seat
    count = again.sum(axis=2)
    known = count > 0
    start = np.einsum("pii->pi", across) - (across * again).sum(axis=2) / np.maximum(1, count)
    return found | {"start": float(start[known].mean()) if known.any() and agents > 1 else np.nan}


def _sides_and_seats(
    products: NDArray[np.float64], used: NDArray[np.bool_], side: NDArray[np.int64], same_seat: NDArray[np.bool_]
) -> dict[str, float]:
    """Fits products of two episodes to whether they share their seat, and then to whether they share their side.

    An effect of two levels adds its variance to products that share it, and takes it from those that do not. Products
    are compared within a partner and, for the seat, within a pair of sides, because partners differ by far more.

    Args:
        products: (P, I, I).
        used: (P, I, I), pairs of different episodes.
        side: (P, I).
        same_seat: (P, I, I).
    """
    partner = np.broadcast_to(np.arange(len(side))[:, None, None], used.shape)[used]
    first, second = (np.broadcast_to(part, used.shape)[used] for part in (side[:, :, None], side[:, None, :]))
    sides = int(side.max()) + 1
    y, by_seat = products[used], np.where(same_seat, 1.0, -1.0)[used]
    seat = _slope(y, by_seat, (partner * sides + first) * sides + second)
    rest = y - (0.0 if np.isnan(seat) else seat) * by_seat
    return {"side": _slope(rest, np.where(first == second, 1.0, -1.0), partner), "seat": seat}


def _slope(y: NDArray[np.float64], x: NDArray[np.float64], group: NDArray[np.int64]) -> float:
    """Fits y to x by least squares within groups; NaN if x varies in none of them."""
    size = np.maximum(1, np.bincount(group))
    y, x = (values - (np.bincount(group, values) / size)[group] for values in (y, x))
    spread = float(x @ x)
    return float(x @ y) / spread if spread > 1e-9 else np.nan
