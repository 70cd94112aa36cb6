"""Self-play by another trainer: stable-baselines3's PPO as it comes, with other networks and settings than ours.

Agents of one trainer resemble each other more than they resemble those of another. This method makes partners that owe
nothing to `learning/learner.py`: SB3's own loops and `MlpPolicy`, or the network and settings of Carroll et al. 2019.
The kitchens, the schedules of partial rewards and entropy, and the files are those of every method.
"""

from dataclasses import dataclass
from typing import Final, Literal

from stable_baselines3 import PPO

from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import find_observation

from .learning.settings import Settings, SettingsError
from .learning.stock import make_stock_ppo
from .running.place import Place
from .running.run import Outcome, make_env, run

METHOD: Final = "stock-ppo"
CODEBASE: Final = "stable-baselines3"
"""Whose learner it is, for a pool's manifest."""


@dataclass(frozen=True, kw_only=True)
class Config(Settings):
    """Trains one policy on both seats of a kitchen by stable-baselines3's own PPO.

    Its `MlpPolicy` keeps actor and critic apart, two layers of 64 tanh units each. Other defaults are SB3's, but for a
    larger, falling learning rate, an entropy bonus, and rollouts and batches for one core.
    """

    steps: int = 400_000
    """Joint steps of training."""
    rollout: int = 100
    """Steps of each kitchen between updates."""
    epochs: int = 6
    """Epochs per rollout."""
    learning_rate: float = 1.5e-3
    """Adam's initial learning rate, annealed linearly."""
    value_coefficient: float = 0.5
    """Value-loss coefficient; with `network` mlp, actor and critic share nothing but the clipping of the gradient."""
    entropy_start: float = 0.02
    """Initial entropy coefficient, annealed linearly."""
    shaping_share: float = 0.8
    """Share of the steps over which the weight of partial rewards is annealed linearly from 1 to 0."""
    start: Literal["random", "standard"] = "standard"
    """random: random floor cells; standard: the layout's start cells."""

    def __post_init__(self) -> None:
        """Refuses stacked states, too, which this convolutional network does not take.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        Settings.__post_init__(self)
        known = isinstance(self.layout, str) and self.layout
        if self.network == "cnn" and known:
            shape = find_observation(self.observation).shape(Layout.load(self.layout))
            if len(shape) != 3:
                raise SettingsError(
                    f"observation={self.observation!r} is no single grid; give network='mlp', or observation='lossless'"
                )


def train(config: Config, place: Place) -> Outcome | None:
    """Trains, freezes and evaluates one policy; see `run` for the result and errors."""

    def make(seed: int) -> PPO:
        return make_stock_ppo(config, make_env(config, self_play=True), seed)

    return run(config, METHOD, place, make)
