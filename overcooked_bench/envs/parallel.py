"""One kitchen as a PettingZoo `ParallelEnv`: both chefs are agents."""

import operator
from collections.abc import Mapping
from pathlib import Path
from typing import Any, ClassVar, Final

import numpy as np
from gymnasium.spaces import Box, Discrete
from numpy.typing import NDArray

from overcooked_bench.envs.event_rewards import shaping_weight
from overcooked_bench.envs.frames import RENDER_FPS, RENDER_MODES, checked_mode, frame
from overcooked_bench.envs.spaces import action_space, observation_space
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import history_for

try:
    from pettingzoo import ParallelEnv
except ModuleNotFoundError:  # the extra is not installed; the constructor says so
    ParallelEnv = None

CHEFS: Final = ("chef_0", "chef_1")


class ParallelKitchen(ParallelEnv if ParallelEnv else object):  # type: ignore[misc]
    """Two chefs in one kitchen, neither of them a partner; `overcooked_bench.parallel_env` makes it.

    Actions, observations and starting states are those of `overcooked_bench.envs.single.OvercookedEnv`, for both seats:
    "chef_0" sits on seat 0, "chef_1" on seat 1. Each chef's reward is the team's soup reward plus `shaping` times its
    own partial reward; its information holds `soup_reward`, `partial_reward` and `seat`. Never terminated; both are
    truncated at the horizon.

    Attributes:
        kitchens: The game itself, one kitchen.
    """

    metadata: ClassVar[dict[str, Any]] = {
        "name": "overcooked_v0",
        "render_modes": list(RENDER_MODES),
        "render_fps": RENDER_FPS,
        "is_parallelizable": True,
    }

    def __init__(
        self,
        layout: str | Path | Layout,
        *,
        observation: str = "lossless",
        cooking: str = "auto",
        start: str = "random",
        object_probability: float = 0.0,
        horizon: int = 400,
        shaping: float = 0.0,
        render_mode: str | None = None,
    ) -> None:
        if ParallelEnv is None:
            raise ModuleNotFoundError(
                "parallel_env needs PettingZoo, which is not installed: pip install 'overcooked-bench[pettingzoo]'"
            )
        self.render_mode = checked_mode(render_mode)
        self.kitchens = Kitchens(
            layout,
            1,
            cooking=cooking,
            horizon=horizon,
            start=start,
            object_probability=object_probability,
            history=history_for([observation]),
            autoreset=False,
        )
        self.possible_agents = list(CHEFS)
        self.agents: list[str] = []
        self.observation_spaces = {chef: observation_space(self.kitchens, observation) for chef in CHEFS}
        self.action_spaces = {chef: action_space() for chef in CHEFS}
        self._observation = observation
        self._shaping = shaping_weight(shaping)
        self._joint = np.zeros((1, 2), np.int64)

    def observation_space(self, agent: str) -> Box:
        """Returns an agent's observation space, the same object at each call."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> "Discrete[Any]":
        """Returns an agent's action space, the same object at each call."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, NDArray[Any]], dict[str, dict[str, Any]]]:
        """Starts an episode.

        Args:
            seed: Seeds the random start states.
            options: Not used.

        Returns:
            Observations and information by agent.
        """
        self.kitchens.reset(seed)
        self.agents = list(CHEFS)
        infos = {chef: {"soup_reward": 0.0, "partial_reward": 0.0, "seat": seat} for seat, chef in enumerate(CHEFS)}
        return self._observe(), infos

    def step(
        self, actions: Mapping[str, Any]
    ) -> tuple[dict[str, NDArray[Any]], dict[str, float], dict[str, bool], dict[str, bool], dict[str, dict[str, Any]]]:
        """Plays one step.

        Args:
            actions: One whole number from 0 to 5 for each agent.

        Returns:
            Observations, rewards, terminations, truncations and information by agent.

        Raises:
            ValueError: The episode is over, an agent's action is missing or out of range.
            TypeError: An action is not a whole number.
        """
        if not self.agents:
            raise ValueError("no episode is being played; call reset() before step()")
        if set(actions) != set(CHEFS):
            raise ValueError(f"actions are given for {sorted(actions)}; give one for each of {', '.join(CHEFS)}")
        for seat, chef in enumerate(CHEFS):
            try:
                self._joint[0, seat] = operator.index(actions[chef])
            except TypeError:
                raise TypeError(f"action {actions[chef]!r} of {chef}; give one whole number from 0 to 5") from None
        result = self.kitchens.step(self._joint)
        soup = float(result.soup_reward.sum())
        over = bool(result.truncated[0])
        rewards, infos = {}, {}
        for seat, chef in enumerate(CHEFS):
            partial = float(result.partial_reward[0, seat])
            rewards[chef] = soup + self._shaping * partial
            infos[chef] = {"soup_reward": soup, "partial_reward": partial, "seat": seat}
        if over:
            self.agents = []
        return self._observe(), rewards, dict.fromkeys(CHEFS, False), dict.fromkeys(CHEFS, over), infos

    def render(self) -> Any:
        """Shows the kitchen as it is now: an (h, w, 3) uint8 picture, or text."""
        return frame(self.kitchens, 0, self.render_mode)

    def _observe(self) -> dict[str, NDArray[Any]]:
        views = self.kitchens.observe(self._observation)[0]
        return {chef: views[seat].copy() for seat, chef in enumerate(CHEFS)}


def parallel_env(
    layout: str | Path | Layout,
    *,
    observation: str = "lossless",
    cooking: str = "auto",
    start: str = "random",
    object_probability: float = 0.0,
    horizon: int = 400,
    shaping: float = 0.0,
    render_mode: str | None = None,
) -> ParallelKitchen:
    """Makes a PettingZoo `ParallelEnv` of one kitchen, with the agents "chef_0" and "chef_1".

    Args:
        layout: A shipped name, a grid's text, the path of a `.layout` file, or a Layout.
        observation: "lossless", "lossless26", "lossless_2019", "blind", "features", "stack_channels" or "stack_states".
        cooking: "auto" or "manual".
        start: "random" or "standard".
        object_probability: Chance of each pot and each pair of hands to be filled at the start.
        horizon: Steps of an episode.
        shaping: Weight of each chef's own partial rewards in its reward.
        render_mode: "rgb_array", "ansi" or None.

    Raises:
        ModuleNotFoundError: PettingZoo is not installed (extra `pettingzoo`).
        ValueError: An argument is out of range; says what to write instead.
    """
    return ParallelKitchen(
        layout,
        observation=observation,
        cooking=cooking,
        start=start,
        object_probability=object_probability,
        horizon=horizon,
        shaping=shaping,
        render_mode=render_mode,
    )
