"""From a trained policy to a frozen one: its files, and what it reaches."""

from pathlib import Path
from typing import Any

import numpy as np

from overcooked_bench.agents.neural import NeuralAgent
from overcooked_bench.agents.policy import ARCHITECTURES, PolicyFiles, load_policy, save_policy
from overcooked_bench.evaluation.play import play_episodes
from overcooked_bench.kitchen.layout import Layout

from .networks import TrunkPolicy
from .settings import Settings

Returns = np.ndarray[tuple[int], np.dtype[np.float64]]


def freeze(stem: Path, policy: TrunkPolicy, settings: Settings) -> PolicyFiles:
    """Writes the actor of a policy, float16."""
    shape = policy.observation_space.shape or ()
    told: dict[str, Any] = {
        "observation": settings.observation,
        "observation_shape": shape,
        "layout": Layout.load(settings.layout).name,
        "cooking": settings.cooking,
        "hidden": settings.hidden,
    }
    if settings.network == "mlp":
        told["activation"] = "relu"
    else:
        told["filters"] = settings.filters
        if settings.observation == "stack_states":
            told["previous"] = settings.previous
    return save_policy(stem, ARCHITECTURES[settings.network](**told), policy.actor_weights())


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
