"""Pretrained partners: a final agent against a population of frozen self-play agents of different seeds.

With their mid-training checkpoints among the partners it is fictitious co-play.

Source: thesis, 5.2.4; Strouse et al. 2021, "Collaborating with humans without human data" (untrained, half-trained and
trained policy of each agent).
"""

import dataclasses
from dataclasses import dataclass, replace
from typing import Final

from overcooked_bench.agents.policies.ensemble import SampledPartners
from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.policies.policy import Policy

from .learning.algorithms import make_learner
from .learning.learner import Learner
from .learning.settings import PartnerSettings, SettingsError, check_draws
from .running.partners import load_partners, partner_names, returns_with
from .running.parts import checkpoints, loaded, self_play_agents
from .running.place import CONFIG_FILE, Place
from .running.run import Outcome, UnfitError, make_env, run
from .self_play import Config as SelfPlay

METHOD: Final = "pretrained-partners"
MOMENTS: Final = (0.0, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8)
"""Shares of a partner's training at which it is saved: the untrained one, and where the half-trained one is sought."""


@dataclass(frozen=True, kw_only=True)
class Config(PartnerSettings):
    """Trains one policy against a population of frozen self-play agents."""

    pool: str = ""
    """A pool whose agents are the population, instead of `agents` that are trained for it; empty trains them."""
    agents: int = 8
    """Self-play agents to train where no pool is given."""
    agent_steps: int = 1_000_000
    """Joint steps of each of them."""
    checkpoints: bool = True
    """Whether their untrained and half-trained policies, or a pool's, are partners too (fictitious co-play)."""
    per_episode: int = 3
    """How many partners are drawn for each episode."""

    def __post_init__(self) -> None:
        """Checks the partners too.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        PartnerSettings.__post_init__(self)
        check_draws(self.per_episode, self.num_kitchens)
        if not self.pool:
            if self.agents < 1:
                raise SettingsError(f"agents={self.agents}; train one agent or more, or give a pool")
            try:
                self_play_config(self, self.agent_steps)
            except ValueError as error:
                raise SettingsError(f"agent_steps={self.agent_steps}: as self-play, {error}") from None

    @property
    def partner_references(self) -> tuple[str, ...]:
        """The partners and pools that the settings name."""
        return (self.pool,) if self.pool else ()


def self_play_config(config: PartnerSettings, steps: int, snapshots: tuple[float, ...] = ()) -> SelfPlay:
    """Returns the settings of the self-play agents that belong to a method: what they share with its learner's."""
    shared = {field.name: getattr(config, field.name) for field in dataclasses.fields(SelfPlay)}
    rollout = max(1, config.rollout // 2)  # both chefs' steps make the same batch
    return SelfPlay(**shared | {"steps": steps, "rollout": rollout, "snapshots": snapshots})


def population(config: Config, place: Place) -> tuple[list[Policy], tuple[Outcome, ...]] | None:
    """Returns the partners and the runs they were trained in, now if need be; None where that was interrupted."""
    if config.pool:
        names = partner_names((config.pool,), config, only_final=not config.checkpoints)
        policies: list[Policy] = []
        for name, agent in zip(names, load_partners(names, config), strict=True):
            if not isinstance(agent, NeuralAgent):
                raise UnfitError(f"{name!r} is no frozen policy; give a pool, or train against it by best-response")
            policies += agent.policies
        return policies, ()
    own = self_play_config(config, config.agent_steps, MOMENTS if config.checkpoints else ())
    outcomes = self_play_agents([own] * config.agents, replace(place, folder=place.folder / "partners"))
    if outcomes is None:
        return None
    files = [outcome.files for outcome in outcomes]
    if config.checkpoints:
        files += [outcome.snapshots[0.0].files for outcome in outcomes]
        files += [outcome.snapshots[checkpoints(outcome, own).half()].files for outcome in outcomes]
    return loaded(files), tuple(outcomes)


def train(config: Config, place: Place) -> Outcome | None:
    """Trains, freezes and evaluates one policy; see `run` for the result and errors."""
    found = population(config, place)
    if found is None:
        return None
    partners, parts = found

    def make(seed: int) -> Learner:
        try:
            sampled = SampledPartners(partners, min(config.per_episode, len(partners)))
        except ValueError as error:
            raise UnfitError(str(error)) from error
        return make_learner(config, make_env(config, partners=[sampled]), seed)

    known = {"partner_hashes": sorted(partner.sha256 for partner in partners)}
    outcome = run(config, METHOD, replace(place, resume=(place.folder / CONFIG_FILE).exists()), make, known=known)
    if outcome is None:
        return None
    with_partners = returns_with(outcome.files, partners, config, max(1, 100 // len(partners)))
    return replace(outcome, with_partners=with_partners, parts=parts)
