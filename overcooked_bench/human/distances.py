"""How far apart two conducts on one layout are, say that of people and that of their proxies."""

import numpy as np

from overcooked_bench.errors import WrongUse
from overcooked_bench.human.conduct import Conduct


def hand_over_distance(one: Conduct, other: Conduct) -> float:
    """Compares where and what is handed over: the total variation distance of the two distributions.

    Returns:
        0 (the same shares of the same counters and objects) to 1 (nothing in common, or only one of the two hands
        anything over). A few hand-overs say little: see `hand_overs` and `steps` too.

    Raises:
        WrongUse: The layouts differ.
    """
    _expect_same_layout(one, other)
    if bool(one.handed) != bool(other.handed):
        return 1.0
    p, q = one.handovers, other.handovers
    return sum(abs(p.get(key, 0.0) - q.get(key, 0.0)) for key in {*p, *q}) / 2


def visit_distance(one: Conduct, other: Conduct) -> float:
    """Compares where the chefs spend their time: total variation distance, 0 to 1, the mean over both chefs.

    Raises:
        WrongUse: The layouts differ.
    """
    _expect_same_layout(one, other)
    return float(np.abs(one.visits - other.visits).sum() / 4)


def _expect_same_layout(one: Conduct, other: Conduct) -> None:
    if one.layout != other.layout:
        raise WrongUse(f"games on {one.layout!r} and on {other.layout!r} cannot be compared; give two of one layout")
