"""What an agent may do and what it sees, as Gymnasium spaces."""

from typing import Any

import numpy as np
from gymnasium.spaces import Box, Discrete

from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.kitchen.kitchens import HISTORY, STACKED, Kitchens

_LEAST_GRID_BOUND = 20


def action_space() -> "Discrete[Any]":
    """Gives the six actions: 0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact."""
    return Discrete(NUM_ACTIONS)


def observation_space(kitchens: Kitchens, observation: str) -> Box:
    """Gives the space of one chef's observation.

    A grid's values reach from 0 to the layout's longest cook time, at least 20 and never 255: stable-baselines3 takes a
    uint8 Box up to 255 for an image. The features' bounds hold every distance in the grid and every remaining time.

    Args:
        kitchens: Kitchens of the layout, with history where the observation is a stack.
        observation: One of "lossless", "lossless26", "features", "stack_channels", "stack_states".

    Returns:
        A uint8 Box of the shape (..., H, W), or a float32 Box of the shape (96,).

    Raises:
        ValueError: The observation is unknown, or this layout does not have it.
    """
    shape = kitchens.observation_shape(observation)
    layout = kitchens.layout
    longest = max(_LEAST_GRID_BOUND, *layout.cook_times)
    if observation == "features":
        side = max(layout.width, layout.height)
        return Box(np.float32(-side), np.float32(max(side, longest)), shape, np.float32)
    return Box(0, longest, shape, np.uint8)


def history_for(*observations: str) -> int:
    """Gives the number of past states that kitchens must keep for these observations."""
    return HISTORY if any(name in STACKED for name in observations) else 0
