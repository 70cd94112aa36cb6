"""Best response: one learner against partners that stay as they are, to it a part of the environment.

Source: thesis, 7.1.1 (the single-agent view: the partner's sampled actions make the environment stochastic). Partners
share out the parallel kitchens evenly; frozen policies of one architecture act in one stacked forward.
"""

import sys
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Final

from .learning.algorithms import A2C_ROLLOUT, DQN_STEPS, Algorithm, AnyLearner, make_a2c, make_dqn, make_learner
from .learning.command import main_of
from .learning.partners import frozen_policies, load_partners, partner_names, returns_with, sharing
from .learning.run import Outcome, UnfitError, make_env, run
from .learning.settings import PartnerSettings, check_draws

METHOD: Final = "best-response"


@dataclass(frozen=True, kw_only=True)
class Config(PartnerSettings):
    """Trains one policy against fixed partners by an algorithm of stable-baselines3."""

    partners: tuple[str, ...] = ("greedy",)
    """Catalogue names, policies, submissions, or pools, whose agents on the layout all play."""
    per_episode: int = 0
    """How many partners are drawn for each episode; 0 lets all play at once."""
    algorithm: Algorithm = "ppo"
    """The learner. A2C has no epochs, minibatches and clip, and rollouts of 20 steps at most; of all PPO's settings DQN
    takes steps, kitchens, learning rates, gamma and gradient norm alone."""

    def __post_init__(self) -> None:
        """Checks the draws too.

        Raises:
            ValueError: Names the setting and what it may be.
        """
        PartnerSettings.__post_init__(self)
        check_draws(self.per_episode, self.num_kitchens, least=0)

    @property
    def update_steps(self) -> int:
        """Joint steps from one update to the next; snapshots are taken in between."""
        rollout = {"ppo": self.rollout, "a2c": min(A2C_ROLLOUT, self.rollout), "dqn": DQN_STEPS}[self.algorithm]
        return self.num_kitchens * rollout


def train(config: Config, output: Path, seed: int, *, resume: bool = False, every: int = 250_000) -> Outcome | None:
    """Trains, freezes and evaluates one policy; see `run` for arguments, result and errors."""
    names = partner_names(config.partners, config)

    def make(seed: int) -> AnyLearner:
        try:
            partners = sharing(load_partners(names, config), config.per_episode)
        except ValueError as error:
            raise UnfitError(str(error)) from error
        env = make_env(config, partners=partners)
        if config.algorithm == "ppo":
            return make_learner(config, env, seed)
        return make_a2c(config, env, seed) if config.algorithm == "a2c" else make_dqn(config, env, seed)

    hashes = [policy.sha256 for policy in frozen_policies(load_partners(names, config))]
    told = {"partner_names": names, "partner_hashes": hashes}
    outcome = run(config, METHOD, output, seed, make, resume=resume, every=every, told=told)
    if outcome is None:
        return None
    episodes = max(1, 100 // len(names))
    return replace(outcome, with_partners=returns_with(outcome.files, load_partners(names, config), config, episodes))


def main(arguments: list[str]) -> int:
    """Runs `overcooked-bench train best-response ...`; gives the exit code: 0, 2 for wrong use, 130 after Ctrl-C."""
    return main_of(METHOD, Config, train, arguments)


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
