"""Self-play: one policy on both seats learns from both seats' experience.

Source: Carroll et al. 2019 (self-play PPO on the lossless encoding, partial rewards annealed to zero); random starts
and an annealed entropy bonus after the thesis, 6.1 and Table 6.1. With `object_probability` it is the state-augmented
self-play that OvercookedV2 (Gessler et al. 2025) holds against zero-shot coordination failures.
"""

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from .learning.algorithms import make_learner
from .learning.command import main_of
from .learning.learner import Learner
from .learning.run import Outcome, make_env, run
from .learning.settings import Settings

METHOD: Final = "self-play"


@dataclass(frozen=True, kw_only=True)
class Config(Settings):
    """Trains one policy on both seats of a kitchen by PPO."""


def train(config: Config, output: Path, seed: int, *, resume: bool = False, every: int = 250_000) -> Outcome | None:
    """Trains, freezes and evaluates one policy; see `run` for arguments, result and errors."""

    def make(seed: int) -> Learner:
        return make_learner(config, make_env(config, self_play=True), seed)

    return run(config, METHOD, output, seed, make, resume=resume, every=every)


def main(arguments: list[str]) -> int:
    """Runs `overcooked-bench train self-play ...`; gives the exit code: 0, 2 for wrong use, 130 after Ctrl-C."""
    return main_of(METHOD, Config, train, arguments)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
