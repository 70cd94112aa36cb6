"""The thesis's own method: agents trained one by one against a population that each of them then joins, and two finals.

Source: thesis, chapter 7. Decided where it is silent: the initial agents are chosen by a rule (`choose`) instead of by
hand; the partners are drawn without replacement for each episode and share out the kitchens evenly; the divergence is
averaged over the whole population that the agent is trained against; every schedule keeps its share of the steps where
an agent is trained for longer; the diversity reward is not annealed. All configurations of one seed share their
initial agents where they share `--initial`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from math import inf
from pathlib import Path
from typing import Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.policies.ensemble import SampledPartners
from overcooked_bench.agents.policies.policy import Policy, load_policy, policy_files
from overcooked_bench.agents.pools.manifest import PoolError
from overcooked_bench.kitchen.layout import Layout

from .learning.algorithms import make_learner
from .learning.inputs import spreader
from .learning.learner import Learner
from .learning.pressure import Pressure
from .learning.settings import PartnerSettings, SettingsError, check_draws
from .pretrained_partners import self_play_config
from .running.locks import alone
from .running.partners import load_partners, partner_names, returns_with
from .running.parts import loaded, self_play_agents
from .running.place import CheckpointError, Place, label, read_record, write_record
from .running.run import POLICY, Outcome, claim, make_env, run

METHOD: Final = "population"
CHOSEN: Final = "chosen.json"
"""Which initial agents were chosen, and why."""
LEAST_SUCCESS: Final = 0.5
"""Share of the best candidate's return with itself that makes a candidate successful."""


@dataclass(frozen=True, kw_only=True)
class Config(PartnerSettings):
    """Trains a diverse population, one agent after the other, and two final agents against it."""

    candidates: int = 5
    """Self-play agents to choose the initial ones from."""
    candidate_steps: int = 1_000_000
    """Joint steps of training of each candidate."""
    chosen: int = 3
    """Initial agents of the population."""
    agents: int = 5
    """Agents that are trained after the initial ones, each of which joins the population."""
    per_episode: int = 3
    """Partners that are drawn from the population for each episode."""
    final_factor: float = 1.5
    """Steps of each final agent, as a multiple of `steps`."""
    reward_coefficient: float = 0.0
    """Weight of the divergence from the population as a reward; 0 for none."""
    reward_clip: float = 0.0
    """Upper bound of that reward per step."""
    loss_coefficient: float = 0.0
    """Weight of the divergence from the population as a loss term; 0 for none."""
    loss_clip: float = 0.0
    """Upper bound of that term per sample."""
    development: str = "dev-v1"
    """Pool or partner whose returns with the candidates measure how much they differ; never the pool that scores."""
    initial: Path | None = None
    """Folder of the candidates, shared by all configurations of one seed; by default next to the run's folder."""

    def __post_init__(self) -> None:
        """Checks the population too.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        PartnerSettings.__post_init__(self)
        if not 1 <= self.chosen <= self.candidates or self.agents < 0:
            raise SettingsError(
                f"candidates={self.candidates}, chosen={self.chosen}, agents={self.agents}; choose from 1 up to all "
                "of the candidates, and train 0 agents or more"
            )
        check_draws(self.per_episode, self.num_kitchens)
        if self.per_episode > self.chosen:
            raise SettingsError(f"per_episode={self.per_episode}; draw at most the {self.chosen} initial agents")
        if not 1 <= self.final_factor < inf:
            raise SettingsError(f"final_factor={self.final_factor}; give a factor from 1")
        for kind in ("reward", "loss"):
            coefficient, clip = getattr(self, f"{kind}_coefficient"), getattr(self, f"{kind}_clip")
            if not (0 < coefficient < inf and 0 < clip < inf) and (coefficient, clip) != (0, 0):
                raise SettingsError(
                    f"{kind}_coefficient={coefficient} with {kind}_clip={clip}; give both above 0, or both as 0"
                )
        try:
            self_play_config(self, self.candidate_steps)
        except ValueError as error:
            raise SettingsError(f"candidate_steps={self.candidate_steps}: as self-play, {error}") from None

    @property
    def partner_references(self) -> tuple[str, ...]:
        """The partners and pools that the settings name."""
        return (self.development,)

    @property
    def presses(self) -> bool:
        """Whether the divergence is rewarded at all."""
        return self.reward_coefficient > 0 or self.loss_coefficient > 0


class _Chosen(msgspec.Struct):
    """What `chosen.json` holds: hashes and returns of the candidates, and the indices of the chosen ones."""

    candidates: list[str]
    own: list[float]
    with_development_partners: list[list[float]]
    chosen: list[int]


def train(config: Config, place: Place, finals: int = 2) -> Outcome | None:
    """Trains the population and the finals; the outcome is the first final's, `final-1` is trained without initials.

    See `run` for errors. Each agent has its own folder under `output`.

    Args:
        config: What to train.
        place: Where.
        finals: 1 leaves out `final-1`.
    """
    try:
        development = partner_names((config.development,), config)
    except PoolError as error:
        raise PoolError(f"{error}; or choose other development partners by --development") from error
    load_partners(development, config)  # before any training, so that a mistake in them shows at once
    claim(place, config, METHOD)
    output = place.folder
    initial = config.initial or output.parent / f"initial-{label(config.layout)}-{place.seed}"
    own = self_play_config(config, config.candidate_steps)
    try:
        with alone(initial):
            candidates = self_play_agents([own] * config.candidates, replace(place, folder=initial))
    except CheckpointError as error:
        raise CheckpointError(f"{error}, or another --initial for the initial agents") from None
    if candidates is None:
        return None
    chosen = _choose(config, [one.files.weights for one in candidates], development, output)
    members = [loaded([candidates[i].files])[0] for i in chosen]
    grown: list[Outcome] = []
    for k in range(config.agents):
        outcome = _against(members, config, place.part(f"agent-{k}", f"agent {k}"))
        if outcome is None:
            return None
        members += loaded([outcome.files])
        grown.append(outcome)
    longer = replace(
        config,
        steps=round(config.final_factor * config.steps),
        reward_coefficient=0.0,
        reward_clip=0.0,
        loss_coefficient=0.0,
        loss_clip=0.0,
    )
    ended = []
    for k, partners in enumerate((members, members[len(chosen) :] or members)[:finals]):
        final = _against(partners, longer, place.part(f"final-{k}", f"final {k}"))
        if final is None:
            return None
        ended.append(final)
    for ours, theirs in zip(policy_files(output / POLICY), ended[0].files, strict=True):
        ours.write_bytes(theirs.read_bytes())
    with_partners = returns_with(ended[0].files, members, config, max(1, 50 // len(members)))
    return replace(
        ended[0],
        files=policy_files(output / POLICY),
        with_partners=with_partners,
        parts=(*candidates, *grown, *ended[1:]),
    )


def choose(own: Sequence[float], vectors: NDArray[np.float64], count: int) -> tuple[int, ...]:
    """Chooses agents that are successful and pairwise as different as possible.

    Successful is who reaches at least half of the best one's return with itself; the best ones where these are too few.
    Two agents are as different as their returns with development partners are far apart (Euclidean distance). Of all
    sets of successful agents that is taken whose distances have the largest sum, and of equal ones the first.

    Args:
        own: (A,) each candidate's return with itself.
        vectors: (A, P) its returns with the development partners.
        count: How many to choose.

    Returns:
        Indices of the chosen, in order.
    """
    order = np.argsort(-np.asarray(own), kind="stable")
    good = [i for i in range(len(own)) if own[i] >= LEAST_SUCCESS * own[order[0]]]
    if len(good) < count:
        good = sorted(int(i) for i in order[:count])
    distance = np.linalg.norm(vectors[:, None] - vectors[None], axis=-1)
    sets = list(combinations(good, count))
    return sets[int(np.argmax([sum(distance[i, j] for i, j in combinations(one, 2)) for one in sets]))]


def _choose(config: Config, files: list[Path], development: Sequence[str], output: Path) -> list[int]:
    """Measures the candidates and chooses; what was found once is read again."""
    place = output / CHOSEN
    hashes = [load_policy(file).sha256 for file in files]
    known = read_record(place, _Chosen)
    if known is not None and known.candidates == hashes:
        return known.chosen
    partners = load_partners(development, config)
    episodes = 20
    own = [
        float(returns_with(policy_files(file), loaded([policy_files(file)]), config, episodes).mean()) for file in files
    ]
    vectors = np.array(
        [
            returns_with(policy_files(file), partners, config, episodes).reshape(len(partners), -1).mean(1)
            for file in files
        ]
    )
    chosen = [int(i) for i in choose(own, vectors, config.chosen)]
    output.mkdir(parents=True, exist_ok=True)
    found = _Chosen(hashes, own, vectors.tolist(), chosen)
    write_record(place, msgspec.to_builtins(found))
    return chosen


def _against(members: Sequence[Policy], config: Config, place: Place) -> Outcome | None:
    """Trains one agent against a population."""

    def make(seed: int) -> Learner:
        env = make_env(config, partners=[SampledPartners(members, min(config.per_episode, len(members)))])
        return make_learner(config, env, seed, _pressure(members, config) if config.presses else None)

    known = {"partner_hashes": [member.sha256 for member in members]}
    return run(config, METHOD, place, make, known=known)


def _pressure(members: Sequence[Policy], config: Config) -> Pressure:
    shape = members[0].architecture.observation_shape
    return Pressure(
        members,
        spreader(Layout.load(config.layout), config.observation, shape),
        reward_coefficient=config.reward_coefficient,
        reward_clip=config.reward_clip,
        loss_coefficient=config.loss_coefficient,
        loss_clip=config.loss_clip,
    )
