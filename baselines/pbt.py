"""Population-based training: agents that learn with each other, and the worst of them replaced by copies of the best.

Source: thesis, 5.2.3; Jaderberg et al. 2017 and Carroll et al. 2019 (pairs drawn from a population, the worst agent
replaced by the best one with mutated hyperparameters). In each round every agent learns against all agents as they were
at the round's start; then all pairs play.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np
import torch
from numpy.typing import NDArray

from overcooked_bench.agents.policies.ensemble import Ensemble
from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.policies.policy import PolicyFiles, load_policy, policy_files
from overcooked_bench.evaluation.games.play import play_episodes

from .learning.algorithms import make_learner
from .learning.freeze import freeze, returns_with_itself
from .learning.learner import Learner
from .learning.settings import PartnerSettings, SettingsError
from .running.partners import returns_with
from .running.parts import loaded
from .running.place import Place, read_record, write_record
from .running.run import CHECKPOINT, POLICY, Outcome, claim, make_env, run
from .running.seeds import part_of

METHOD: Final = "pbt"
ROUNDS: Final = "rounds.json"
"""What each round measured and changed."""
MUTABLE: Final = ("learning_rate", "entropy_start", "value_coefficient", "clip")
"""Hyperparameters that copies mutate; where one is the start of a schedule, its end changes by the same factor."""
_ENDS: Final = {"learning_rate": "learning_rate_end", "entropy_start": "entropy_end"}


@dataclass(frozen=True, kw_only=True)
class Config(PartnerSettings):
    """Trains a population of policies that learn with each other."""

    agents: int = 4
    """Policies of the population."""
    rounds: int = 10
    """How often all pairs play and the worst are replaced; `steps` are shared out over rounds, for each agent."""
    replaced: int = 1
    """Agents that are replaced after a round."""
    mutation: float = 1.25
    """Each hyperparameter of a copy is multiplied or divided by this, or stays, with equal chance."""
    pair_episodes: int = 10
    """Episodes of each pair and seat after a round."""

    def __post_init__(self) -> None:
        """Checks the population too.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        PartnerSettings.__post_init__(self)
        if self.agents < 2 or not 0 <= self.replaced <= self.agents // 2 or self.rounds < 1 or self.mutation < 1:
            raise SettingsError(
                f"agents={self.agents}, rounds={self.rounds}, replaced={self.replaced}, mutation={self.mutation}; give "
                "at least 2 agents, 1 round, at most half of the agents to replace, and a factor from 1"
            )
        least = 2 * self.num_kitchens * self.rollout
        if self.agents > self.num_kitchens or self.steps // self.rounds < least:
            raise SettingsError(
                f"rounds={self.rounds} of {self.steps // self.rounds} steps with {self.agents} agents; a round needs "
                f"two updates, {least} joint steps, and each agent a kitchen"
            )
        if self.check_share or self.snapshots:
            raise SettingsError(
                f"check_share={self.check_share}, snapshots={self.snapshots}; leave both out: a population replaces "
                "who learns too little, and keeps the policies of every round"
            )


@dataclass(frozen=True, kw_only=True)
class Leg(PartnerSettings):
    """One agent's part of one round: schedules are those of the whole run."""

    begun: int
    """Joint steps that this agent had done before."""
    whole: int
    """Joint steps of the whole run."""

    def learning_rate_at(self, left: float) -> float:
        """Returns the learning rate where the share `left` of this leg is left."""
        passed = min(1.0, (self.begun + (1 - max(0.0, left)) * self.steps) / self.whole)
        return self.learning_rate + (self.learning_rate_end - self.learning_rate) * passed

    def _passed(self, done: int, share: float) -> float:
        return min(1.0, (self.begun + done) / (share * self.whole)) if share else 1.0


class _Round(msgspec.Struct):
    """What a round measured and changed."""

    pairs: list[list[float]]
    source: list[int]
    hyperparameters: list[dict[str, float]]


def train(config: Config, place: Place) -> Outcome | None:
    """Trains the population; the outcome is that of the agent that plays best with all of them at the end.

    See `run` for errors.
    """
    claim(place, config, METHOD)
    output, seed = place.folder, place.seed
    history = (read_record(output / ROUNDS, list[_Round]) or []) if place.resume else []
    parents = _first_agents(config, output, seed)
    hyper = [{name: getattr(config, name) for name in MUTABLE} for _ in range(config.agents)]
    legs: list[Outcome] = []
    scores = np.zeros((config.agents, config.agents))
    for number in range(config.rounds):
        folder = output / f"round-{number}"
        outcomes = []
        for k in range(config.agents):
            part = place.part(f"round-{number}/agent-{k}", f"{number} {k}")
            leg = _learn(config, number, k, hyper[k], parents, part)
            if leg is None:
                return None
            outcomes.append(leg)
        legs += outcomes
        if number == len(history):
            measured = pairwise([leg.files for leg in outcomes], config)
            source, hyper_next = exploit(measured, hyper, config, part_of(seed, f"{number} replaced"))
            history.append(_Round(measured.tolist(), source, hyper_next))
            write_record(output / ROUNDS, msgspec.to_builtins(history))
        scores, hyper = np.asarray(history[number].pairs), history[number].hyperparameters
        parents = [folder / f"agent-{source}" for source in history[number].source]
    best = int(scores.mean(1).argmax())
    for ours, theirs in zip(policy_files(output / POLICY), outcomes[best].files, strict=True):
        ours.write_bytes(theirs.read_bytes())
    final = policy_files(output / POLICY)
    others = loaded([leg.files for k, leg in enumerate(outcomes) if k != best])
    with_partners = returns_with(final, others, config, max(1, 100 // len(others)))
    column = legs[best :: config.agents]  # as long as those of the agents it is a copy of
    return Outcome(
        final,
        returns_with_itself(final, config),
        sum(leg.steps for leg in column),
        sum(leg.seconds for leg in column),
        with_partners=with_partners,
        parts=tuple(leg for k, leg in enumerate(legs) if k % config.agents != best),
        legs=config.rounds,
    )


def pairwise(files: list[PolicyFiles], config: Config) -> NDArray[np.float64]:
    """Lets all pairs play, both seats.

    Returns:
        (A, A) mean points per pair: soups, and partial rewards by a tenth, which separate agents before any soup.
    """
    scores = np.zeros((len(files), len(files)))
    policies = loaded(files)
    for i, ego in enumerate(policies):
        for j in range(i, len(policies)):
            games = [
                play_episodes(
                    config.layout,
                    agents=(NeuralAgent(a), NeuralAgent(b)),
                    episodes=config.pair_episodes,
                    cooking=config.cooking,
                    start=config.start,
                    horizon=config.horizon,
                )
                for a, b in ((ego, policies[j]), (policies[j], ego))
            ]
            points = [np.mean(g.soup_reward) + 0.1 * np.mean(np.sum(g.partial_reward, 1)) for g in games]
            scores[i, j] = scores[j, i] = np.mean(points)
    return scores


def exploit(
    scores: NDArray[np.float64], hyper: list[dict[str, float]], config: Config, seed: int
) -> tuple[list[int], list[dict[str, float]]]:
    """Replaces the worst agents by copies of the best ones, with mutated hyperparameters.

    Args:
        scores: (A, A) of `pairwise`.
        hyper: Each agent's hyperparameters.
        config: The run's.
        seed: Of the mutations.

    Returns:
        Whom each agent is a copy of, itself where it stays, and its hyperparameters for the next round.
    """
    order = np.argsort(-scores.mean(1), kind="stable")
    source, after = list(range(len(hyper))), [dict(one) for one in hyper]
    rng = np.random.default_rng(seed)
    for rank in range(config.replaced):
        best, worst = int(order[rank]), int(order[-1 - rank])
        factors = config.mutation ** rng.integers(-1, 2, len(MUTABLE)).astype(float)
        source[worst] = best
        after[worst] = {name: float(hyper[best][name] * factor) for name, factor in zip(MUTABLE, factors, strict=True)}
    return source, after


def scheduled(hyper: dict[str, float], config: Config) -> dict[str, float]:
    """Returns hyperparameters with the ends of their schedules, which keep their proportion to the starts."""
    ends = {
        end: getattr(config, end) * (hyper[start] / getattr(config, start))
        for start, end in _ENDS.items()
        if getattr(config, start)
    }
    return {**hyper, **ends}


def _first_agents(config: Config, output: Path, seed: int) -> list[Path]:
    """Freezes the untrained agents, so that the first round has partners."""
    folders = [output / "untrained" / f"agent-{k}" for k in range(config.agents)]
    for k, folder in enumerate(folders):
        if not policy_files(folder / POLICY).architecture.exists():
            model = make_learner(config, make_env(config), part_of(seed, f"untrained {k}"))
            folder.mkdir(parents=True, exist_ok=True)
            torch.save(_learned(model), folder / CHECKPOINT)
            freeze(folder / POLICY, model, config)  # at last: it says that the agent is there
    return folders


def _learn(
    config: Config,
    number: int,
    k: int,
    hyper: dict[str, float],
    parents: list[Path],
    place: Place,
) -> Outcome | None:
    steps = config.steps // config.rounds
    own = {field: getattr(config, field) for field in PartnerSettings.__dataclass_fields__}
    leg = Leg(**own | scheduled(hyper, config) | {"steps": steps}, begun=number * steps, whole=config.steps)

    def make(seed: int) -> Learner:
        partners = Ensemble([load_policy(parent / POLICY) for parent in parents])
        partners.assign(np.arange(config.num_kitchens) * len(parents) // config.num_kitchens)
        model = make_learner(leg, make_env(leg, partners=[partners]), seed)
        content = torch.load(parents[k] / CHECKPOINT, weights_only=True)
        model.policy.load_state_dict(content["policy"])
        model.policy.optimizer.load_state_dict(content["optimizer"])
        return model

    known = {"partner_hashes": [load_policy(parent / POLICY).sha256 for parent in parents], "hyperparameters": hyper}
    return run(leg, METHOD, place, make, known=known)


def _learned(model: Learner) -> dict[str, Any]:
    return {"policy": model.policy.state_dict(), "optimizer": model.policy.optimizer.state_dict()}
