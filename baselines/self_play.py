"""Self-play: one policy on both seats learns from both seats' experience.

Source: Carroll et al. 2019 (self-play PPO on the lossless encoding, partial rewards annealed to zero); random starts
and an annealed entropy bonus after the thesis, 6.1 and Table 6.1. With `object_probability` it is the state-augmented
self-play that OvercookedV2 (Gessler et al. 2025) holds against zero-shot coordination failures.
"""

from dataclasses import dataclass
from typing import Final

from .learning.algorithms import make_learner
from .learning.learner import Learner
from .learning.settings import Settings
from .running.place import Place
from .running.run import Outcome, make_env, run

METHOD: Final = "self-play"


@dataclass(frozen=True, kw_only=True)
class Config(Settings):
    """Trains one policy on both seats of a kitchen by PPO."""


def train(config: Config, place: Place) -> Outcome | None:
    """Trains, freezes and evaluates one policy; see `run` for the result and errors."""

    def make(seed: int) -> Learner:
        return make_learner(config, make_env(config, self_play=True), seed)

    return run(config, METHOD, place, make)
