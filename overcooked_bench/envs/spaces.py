"""Action and observation spaces of Gymnasium."""

from typing import Any

from gymnasium.spaces import Box, Discrete

from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.observations.registry import find_observation


def action_space() -> "Discrete[Any]":
    """Returns the six actions: 0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact."""
    return Discrete(NUM_ACTIONS)


def observation_space(kitchens: Kitchens, observation: str) -> Box:
    """Returns the space of one chef's observation.

    Args:
        kitchens: Kitchens of the layout, with history if the observation is a stack.
        observation: A name of `observations.registry.OBSERVATIONS`.

    Returns:
        A Box of the observation's type, shape and bounds in this layout; never a uint8 Box up to 255, which
        stable-baselines3 would take for an image.

    Raises:
        ValueError: The observation is unknown, or this layout does not have it.
    """
    shape, seen = kitchens.observation_shape(observation), find_observation(observation)
    low, high = (seen.dtype.type(bound) for bound in (seen.low(kitchens.layout), seen.high(kitchens.layout)))
    return Box(low, high, shape, seen.dtype.type)
