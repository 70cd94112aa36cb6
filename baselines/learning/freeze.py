"""Freezes a trained policy: writes its files and measures its returns."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final, Protocol, runtime_checkable

import numpy as np
import torch
from stable_baselines3 import DQN, PPO
from stable_baselines3.common.base_class import BaseAlgorithm

from overcooked_bench.agents.policies.architecture import Architecture
from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.policies.policy import ARCHITECTURES, PolicyFiles, load_policy, save_policy
from overcooked_bench.evaluation.games.play import play_episodes
from overcooked_bench.kitchen.layout import Layout

from .networks import Trunk, TrunkPolicy
from .settings import Settings
from .stock import stock_weights

Returns = np.ndarray[tuple[int], np.dtype[np.float64]]


GREEDINESS: Final = 100.0
"""Values of actions, less their mean, become log-probabilities times this: sampling nearly always takes the best."""


@runtime_checkable
class Freezable(Protocol):
    """A learner's policy that knows which architecture its actor has."""

    def frozen(self, told: Mapping[str, Any]) -> tuple[Architecture, dict[str, torch.Tensor]]:
        """Returns the frozen actor's description and tensors; `told` are the fields of every `Architecture`."""


def freeze(stem: Path, model: BaseAlgorithm, settings: Settings) -> PolicyFiles:
    """Writes the actor of a learner, float16; of DQN its network of values, sharpened."""
    shape = model.observation_space.shape or ()
    told: dict[str, Any] = {
        "observation": settings.observation,
        "observation_shape": shape,
        "layout": Layout.load(settings.layout).name,
        "cooking": settings.cooking,
    }
    if isinstance(model.policy, Freezable):
        return save_policy(stem, *model.policy.frozen(told))
    told["hidden"] = settings.hidden
    if settings.network == "mlp":
        told["activation"] = "tanh" if type(model) is PPO else "relu"
    else:
        told["filters"] = settings.filters
        if len(shape) == 4:  # past states are stacked
            told["previous"] = settings.previous
    return save_policy(stem, ARCHITECTURES[settings.network](**told), _actor_weights(model))


def _actor_weights(model: BaseAlgorithm) -> dict[str, torch.Tensor]:
    if isinstance(model.policy, TrunkPolicy):
        return model.policy.actor_weights()
    if type(model) is PPO:
        return stock_weights(model.policy)
    assert isinstance(model, DQN)
    trunk, values = model.q_net.features_extractor, model.q_net.q_net[-1]
    assert isinstance(trunk, Trunk)
    assert isinstance(values, torch.nn.Linear)
    parts: dict[str, torch.Tensor] = {"weight": values.weight, "bias": values.bias}
    # what all actions have in common says nothing, and would take the digits that float16 has
    action = {f"action.{part}": GREEDINESS * (tensor - tensor.mean(0)) for part, tensor in parts.items()}
    return {name: tensor.detach().cpu().clone() for name, tensor in (trunk.weights() | action).items()}


def returns_with_itself(files: PolicyFiles, settings: Settings, episodes: int = 100) -> Returns:
    """Plays a frozen policy with itself: (episodes,) soup reward, sampled actions, in points."""
    pair = tuple(NeuralAgent(load_policy(files.weights)) for _ in range(2))
    games = play_episodes(
        settings.layout,
        agents=(pair[0], pair[1]),
        episodes=episodes,
        cooking=settings.cooking,
        start=settings.start,
        horizon=settings.horizon,
    )
    return np.asarray(games.soup_reward, np.float64)
