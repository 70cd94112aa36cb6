"""Rewards for events besides delivered soups: a weight for each of the kitchen's events.

Self-play under random weights makes partners with habits of their own (Yu et al. 2023, "Learning Zero-Shot Cooperation
with Humans, Assuming Humans Are Biased").
"""

from collections.abc import Mapping
from math import isfinite

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen.events import EVENTS
from overcooked_bench.shelf import guess


def shaping_weight(shaping: float) -> float:
    """Returns the weight of partial rewards.

    Raises:
        WrongUse: It is no finite number.
    """
    if not isfinite(shaping):
        raise WrongUse(f"shaping={shaping!r}; give a finite weight of the partial rewards, such as 0.0 or 1.0")
    return float(shaping)


def event_weights(event_rewards: Mapping[str, float]) -> NDArray[np.float64]:
    """Returns the weight of every event.

    Args:
        event_rewards: Names of `EVENTS` to reward points; events that are not named have the weight 0.

    Returns:
        (25,) float64 in the order of `EVENTS`.

    Raises:
        ValueError: An unknown event (suggests the nearest), or a weight that is not a finite number.
    """
    weights = np.zeros(len(EVENTS))
    for name, weight in event_rewards.items():
        if name not in EVENTS:
            raise ValueError(f"event_rewards names {name!r}; {guess(name, EVENTS)}Events are {', '.join(EVENTS)}")
        if not isfinite(weight):
            raise ValueError(f"event_rewards[{name!r}]={weight!r}; give a finite number of reward points")
        weights[EVENTS.index(name)] = weight
    return weights
