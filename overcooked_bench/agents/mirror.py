"""Adapts an agent of a kitchen to that kitchen's mirror image."""

from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.agents.agent import Agent, UnknownLayout
from overcooked_bench.kitchen.codes import ACTION_NAMES
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState, row_major

if TYPE_CHECKING:
    from overcooked_bench.kitchen.observations.observation import Observation

_EXCHANGED = {"east": "west", "west": "east"}
_ACTIONS = {ACTION_NAMES.index(a): ACTION_NAMES.index(b) for a, b in _EXCHANGED.items()}


def mirrored(agent: Agent) -> Agent:
    """Makes an agent that plays the mirror image of every kitchen that the given one plays.

    The agent is given the mirrored layout's name (so for `cramped_room-mirrored` the plain one), sees everything
    reversed left to right, and its east and west are exchanged.

    Args:
        agent: Sees a grid or states. The 96 features cannot be mirrored: between two objects at the same distance they
            choose by column, which cannot be recovered from the features.

    Raises:
        UnknownLayout: The agent's observation cannot be mirrored.
    """
    from overcooked_bench.kitchen.observations.registry import find_observation

    seen = None if agent.observation == "state" else find_observation(agent.observation)
    if seen and not seen.can_mirror:
        raise UnknownLayout(
            f"an agent that observes {agent.observation!r} cannot be shown a mirrored kitchen; grids and states can be "
            "mirrored"
        )
    return _Mirrored(agent, seen)


class _Mirrored:
    """The adapter of `mirrored`."""

    def __init__(self, agent: Agent, seen: "Observation | None") -> None:
        self.observation = agent.observation
        self._agent, self._seen = agent, seen
        self._width = 0

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        shown = Layout.load(layout).mirrored()
        self._width = shown.width
        self._agent.reset(shown.name, seats, seeds)

    def act(self, observations: Any) -> ArrayLike:
        if self._seen is None:
            return mirror_actions(self._agent.act([mirror_state(state, self._width) for state in observations]))
        return mirror_actions(self._agent.act(self._seen.mirrored(observations)))


def mirror_state(state: KitchenState, width: int) -> KitchenState:
    """Reverses a state left to right in a kitchen of `width` columns."""
    first, second = (
        replace(
            chef,
            position=(width - 1 - chef.position[0], chef.position[1]),
            facing=_EXCHANGED.get(chef.facing, chef.facing),
        )
        for chef in state.chefs
    )
    objects = row_major({(width - 1 - x, y): thing for (x, y), thing in state.objects.items()})
    return replace(state, chefs=(first, second), objects=objects)


def mirror_actions(actions: ArrayLike) -> NDArray[Any]:
    """Exchanges east and west; other values are left for the caller to check."""
    given = np.asarray(actions)
    exchanged = given.copy()
    for action, other in _ACTIONS.items():
        exchanged[given == action] = other
    return exchanged
