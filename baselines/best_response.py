"""Best response: one learner trained with fixed partners, which are part of its environment.

Source: thesis, 7.1.1 (the single-agent view: the partner's sampled actions make the environment stochastic). Partners
share out the parallel kitchens evenly; frozen policies of one architecture act in one stacked forward.
"""

from dataclasses import dataclass, replace
from typing import Final

from .learning.algorithms import Algorithm, AnyLearner, make_a2c, make_dqn, make_learner
from .learning.settings import PartnerSettings, check_draws
from .running.partners import frozen_policies, load_partners, partner_names, returns_with, sharing
from .running.place import Place
from .running.run import Outcome, UnfitError, make_env, run

METHOD: Final = "best-response"


@dataclass(frozen=True, kw_only=True)
class Config(PartnerSettings):
    """Trains one policy against fixed partners by an algorithm of stable-baselines3."""

    partners: tuple[str, ...] = ("greedy",)
    """Agent names, policy files, submissions or pools; of a pool, all frozen agents of the layout play."""
    per_episode: int = 0
    """Partners drawn per episode; with 0 all play, each in its share of the kitchens."""
    algorithm: Algorithm = "ppo"
    """The algorithm. A2C ignores epochs, minibatches and clip, and its rollouts have at most 20 steps. Of PPO's
    settings DQN uses only steps, num_kitchens, the learning rates, gamma and max_grad_norm."""

    def __post_init__(self) -> None:
        """Checks the draws too.

        Raises:
            ValueError: Names the setting and what it may be.
        """
        PartnerSettings.__post_init__(self)
        check_draws(self.per_episode, self.num_kitchens, least=0)

    @property
    def partner_references(self) -> tuple[str, ...]:
        """The partners and pools that the settings name."""
        return self.partners


def train(config: Config, place: Place) -> Outcome | None:
    """Trains, freezes and evaluates one policy; see `run` for the result and errors."""
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
    known = {"partner_names": names, "partner_hashes": hashes}
    outcome = run(config, METHOD, place, make, known=known)
    if outcome is None:
        return None
    episodes = max(1, 100 // len(names))
    return replace(outcome, with_partners=returns_with(outcome.files, load_partners(names, config), config, episodes))
