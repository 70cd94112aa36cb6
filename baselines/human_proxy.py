"""Human proxies: clones of people in recorded games, and clones that were then trained to earn more without changing.

A clone alone is a weak partner where a hand-over can fail in many ways: one odd step leads to states that no person
was ever in. So the clone goes on to learn by PPO and pays for its divergence from the clone. Both are kept: the clone,
and the regularised one. By default it learns on both seats: another clone gets lost as well, and with it nobody earns
enough to learn from. Where two regularised ones then do not understand each other's hand-overs (forced_coordination),
it goes on with others of the same people that learned in the same way (`partners="others"`).

Source: Carroll et al. 2019 (clones of the same games); Jaques et al. 2017, "Sequence Tutor", and Jacob et al. 2022,
"Modeling strong and human-like gameplay with KL-regularized search" (a divergence from cloned play as the price of
earning more).
"""

import hashlib
from dataclasses import dataclass, replace
from typing import Any, Final, Literal

from overcooked_bench.agents.policies.ensemble import SampledPartners
from overcooked_bench.agents.policies.policy import Policy, load_policy
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import is_file, read_regular
from overcooked_bench.human.game import GamesError
from overcooked_bench.human.games import MOST_BYTES, read_games
from overcooked_bench.human.people import chosen, chosen_pairs
from overcooked_bench.kitchen.layout import Layout

from .cloning.bootstrap import bootstrap
from .cloning.clone import CloneSettings
from .cloning.examples import Examples, examples, people_in
from .cloning.lesson import Lesson
from .cloning.stage import Clone, clone
from .learning.algorithms import make_learner
from .learning.inputs import spreader
from .learning.learner import Learner
from .learning.pressure import Pressure
from .learning.settings import SettingsError, check_draws
from .running.checkpoint import load_weights
from .running.partners import returns_with
from .running.parts import loaded
from .running.place import CONFIG_FILE, Place
from .running.run import CHECKPOINT, Outcome, Snapshot, check_device, claim, make_env, run

METHOD: Final = "human-proxy"
GAMES: Final = "runs/human/2019.games.jsonl"
"""Where `overcooked-bench games import-2019` writes."""
ALONE: Final = "alone"
"""A run's folder of what it is after learning with itself, with partners others."""


@dataclass(frozen=True, kw_only=True)
class Config(CloneSettings):
    """Clones people, then trains the clone with other clones of them."""

    games: str = GAMES
    """Games file of people; `overcooked-bench games import-2019` makes one."""
    pairs: str = "A"
    """Whom to learn from: A or B, which share no person, or a list of pairs of 2019 or other groups, such as 3,5,7."""
    stage: Literal["clone", "regularised"] = "regularised"
    """clone: stop after cloning; regularised: then train the clone by PPO."""
    coefficient: float = 0.1
    """Weight of the divergence from the clone, in nats per step, in PPO's loss."""
    lesson_coefficient: float = 0.5
    """Weight of the divergence of the clone from the learner on the steps of the cloned people, in PPO's loss."""
    lesson_batch: int = 512
    """Steps of people in each minibatch of PPO."""
    partners: Literal["itself", "clones", "others"] = "itself"
    """itself: it plays both seats and learns on both; clones: it plays one seat, and clones of other bootstraps of the
    same pairs the other; others: first it learns with itself, and so do those clones; then it goes on with what they
    and itself have become as its partners."""
    agents: int = 3
    """Number of those other clones."""
    alone_steps: int = 500_000
    """Joint steps that each learns with itself first, with partners others."""
    alone_coefficient: float = 0.2
    """Weight of the divergence from the clone meanwhile."""
    per_episode: int = 3
    """How many of them play at a time."""
    steps: int = 1_000_000
    """Joint steps of training after cloning."""
    rollout: int = 200
    """Steps of each kitchen between updates."""
    hidden: tuple[int, ...] = (128, 128)
    """Widths of the fully connected layers that actor and critic share."""
    learning_rate: float = 1e-3
    """Adam's initial learning rate, annealed linearly."""
    entropy_start: float = 0.0
    """Initial entropy coefficient; the divergence from the clone keeps the policy from becoming certain."""
    entropy_end: float = 0.0
    """Final entropy coefficient."""
    shaping_share: float = 1.0
    """Share of the steps over which the weight of partial rewards is annealed linearly from 1 to 0."""

    def __post_init__(self) -> None:
        """Checks the cloning too.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        CloneSettings.__post_init__(self)
        for name in ("coefficient", "lesson_coefficient", "alone_coefficient"):
            if getattr(self, name) < 0:
                raise SettingsError(f"{name}={getattr(self, name)}; give a number from 0")
        if self.lesson_batch < 1:
            raise SettingsError(f"lesson_batch={self.lesson_batch}; give a number from 1")
        if self.agents < 1:
            raise SettingsError(f"agents={self.agents}; train one other clone or more")
        if self.partners == "clones":
            check_draws(self.per_episode, self.num_kitchens)
            if self.per_episode > self.agents:
                raise SettingsError(f"per_episode={self.per_episode}; draw at most the {self.agents} other clones")
        if self.snapshots:
            raise SettingsError(
                f"snapshots={self.snapshots}; leave them out, the clone alone is kept beside the last policy"
            )
        chosen_pairs(self.pairs)

    @property
    def alone(self) -> "Config":
        """The settings with which it learns with itself first."""
        return replace(
            self,
            partners="itself",
            steps=self.alone_steps,
            coefficient=self.alone_coefficient,
            rollout=max(1, self.rollout // 2),  # both chefs' steps make the same batch
        )

    @property
    def learning_seats(self) -> int:
        """Number of chefs per kitchen whose experience trains the policy."""
        return 2 if self.partners == "itself" else 1

    @property
    def people(self) -> tuple[str, ...]:
        """The pairs of people that are cloned."""
        return chosen_pairs(self.pairs)


def train(config: Config, place: Place) -> Outcome | None:
    """Clones people, trains the clone further, freezes both and evaluates them.

    Returns:
        The outcome of the last stage, with the clone as its only snapshot; None if it was interrupted and saved.

    Raises:
        GamesError: The games file is missing, or a game does not replay.
        WrongUse: The file has too few of these people on the layout.
        CheckpointError: The folder holds another run, or something damaged.
        UnfitError: The settings do not fit the layout, or there is no such device.
    """
    check_device(config)
    digest, rows = games_digest(config.games), people_of(config)

    def cloned(part: str, place: Place = place) -> Clone:
        own = place.part(part, part)
        return clone(config, own, bootstrap(rows.people, own.seed), rows)

    before = _alone(config, place)
    if before is None:
        return None
    first = cloned("clone", place.part(ALONE, ALONE) if before else place)
    known: dict[str, Any] = {
        "games_sha256": digest,
        "drawn": list(first.sample.drawn),
        "held_out": list(first.sample.held_out),
        "clone_nats": round(first.nats, 4),
    }
    clone_itself = Snapshot(first.files, first.steps)
    place = replace(place, resume=(place.folder / CONFIG_FILE).exists())
    if config.stage == "clone":
        claim(place, config, METHOD, known)
        return Outcome(first.files, first.returns, first.steps, first.seconds, {0.0: clone_itself})
    partners = loaded([one.files for one in before])
    if config.partners == "clones":
        partners = loaded([cloned(f"partner-{k}").files for k in range(config.agents)])

    def make(seed: int) -> Learner:
        theirs = rows.of(first.sample.drawn)
        model = _held_to(config, first, theirs, partners, len(before) or config.per_episode, seed)
        if before:
            load_weights(place.folder / ALONE / CHECKPOINT, model)
        return model

    outcome = run(config, METHOD, place, make, known=known)
    if outcome is None:
        return None
    return replace(
        outcome,
        steps=(before[0].steps if before else first.steps) + outcome.steps,
        seconds=outcome.seconds + (0 if before else first.seconds),
        snapshots={0.0: clone_itself},
        parts=tuple(before),
        with_partners=returns_with(outcome.files, partners, config, max(1, 100 // len(partners))) if partners else None,
    )


def games_digest(file: str) -> str:
    """Returns the SHA-256 of a games file.

    Raises:
        GamesError: It is missing or cannot be read; says how to make one.
    """
    if not is_file(file):
        raise GamesError(
            f"{file}: no such file; `overcooked-bench games import-2019` writes {GAMES}, or give another games file by "
            "--games"
        )
    return hashlib.sha256(read_regular(file, MOST_BYTES, raises=GamesError)).hexdigest()


def _alone(config: Config, place: Place) -> list[Outcome] | None:
    """Trains what is to learn with itself first: itself, then the others; none unless the partners are others.

    Returns:
        Their outcomes, or None if one was interrupted and saved.
    """
    parts = [ALONE, *(f"other-{k}" for k in range(config.agents))]
    outcomes = []
    for part in parts if (config.stage, config.partners) == ("regularised", "others") else []:
        outcome = train(config.alone, place.part(part, part))
        if outcome is None:
            return None
        outcomes.append(outcome)
    return outcomes


def _held_to(
    config: Config, first: Clone, theirs: Examples, partners: list[Policy], per_episode: int, seed: int
) -> Learner:
    """Makes a learner with the clone's weights, which pays for its divergence from it."""
    if partners:
        env = make_env(config, partners=[SampledPartners(partners, per_episode)])
    else:
        env = make_env(config, self_play=True)
    spread = spreader(Layout.load(config.layout), config.observation, env.observation_space.shape or ())
    # a bonus of less than 0: the price of the divergence
    anchor = Pressure([load_policy(first.files.weights)], spread, loss_coefficient=-config.coefficient, loss_clip=0.0)
    model = make_learner(config, env, seed, anchor if config.coefficient else None)
    first.restore(model)
    if config.lesson_coefficient:
        model.lesson = Lesson(model.policy, theirs, config.lesson_coefficient, config.lesson_batch)
    return model


def people_of(config: Config) -> Examples:
    """Returns what the chosen people did on the layout.

    Raises:
        GamesError: The games file is missing, or a game does not replay.
        WrongUse: They have no game there, or games of another cooking mode.
    """
    layout = Layout.load(config.layout).name
    theirs = [game for game in chosen(read_games(config.games), config.pairs) if people_in(game)]
    games = [game for game in theirs if game.kitchen.name == layout]
    if not games:
        known = ", ".join(sorted({repr(game.kitchen.name) for game in theirs})) or "no layout"
        raise WrongUse(f"{config.games}: no game of the pairs {config.pairs} on {layout!r}; they played {known}")
    strange = sorted({game.cooking for game in games} - {config.cooking})
    if strange:
        raise WrongUse(f"{config.games}: games of cooking {strange[0]!r}; train with --cooking {strange[0]}")
    return examples(games, config.layout, config.observation, config.gamma)
