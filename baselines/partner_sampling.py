"""Partner sampling: self-play whose partner is drawn from the learner's own saved past.

Source: thesis, 5.2.2. The policy is saved every `save_every` joint steps; each episode is played with a few of the
saved policies, drawn uniformly, that share out the kitchens.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.callbacks import BaseCallback

from overcooked_bench.agents.policies.ensemble import SampledPartners
from overcooked_bench.agents.policies.policy import Policy, load_policy, policy_files

from .learning.algorithms import make_learner
from .learning.freeze import freeze
from .learning.learner import Learner
from .learning.settings import PartnerSettings, SettingsError, check_draws
from .running.place import Place
from .running.run import Outcome, make_env, run

METHOD: Final = "partner-sampling"
PAST: Final = "past"


@dataclass(frozen=True, kw_only=True)
class Config(PartnerSettings):
    """Trains one policy against partners drawn from its own past."""

    save_every: int = 100_000
    """Joint steps between two saved policies."""
    per_episode: int = 3
    """How many of them play in each episode."""

    def __post_init__(self) -> None:
        """Checks the past too.

        Raises:
            SettingsError: Names the setting and what it may be.
        """
        PartnerSettings.__post_init__(self)
        check_draws(self.per_episode, self.num_kitchens)
        if self.save_every < 1:
            raise SettingsError(f"save_every={self.save_every}; give a number from 1")


class PastSelves:
    """The partner: policies saved in a folder before the running episode began.

    Args:
        config: The run's.
        folder: Where they lie, named by the joint steps after which they were saved.

    Attributes:
        observation: What they see.
        next: Joint steps at the next reset.
    """

    def __init__(self, config: Config, folder: Path) -> None:
        self.observation: str = config.observation
        self.next = 0
        self._folder, self._config = folder, config
        self._known: dict[int, Policy] = {}
        self._playing: SampledPartners | None = None

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts new episodes with policies saved before; the first one with the untrained policy."""
        now, self.next = self.next, self.next + self._config.num_kitchens * self._config.horizon
        born = sorted(int(file.stem) for file in self._folder.glob("*.safetensors"))
        policies = [self._policy(steps) for steps in born if steps < max(now, 1)]
        self._playing = SampledPartners(policies, min(self._config.per_episode, len(policies)))
        self._playing.reset(layout, seats, seeds)

    def act(self, observations: Any) -> NDArray[np.int64]:
        """Chooses one action per row."""
        assert self._playing is not None
        return self._playing.act(observations)

    def _policy(self, steps: int) -> Policy:
        if steps not in self._known:
            self._known[steps] = load_policy(self._folder / str(steps))
        return self._known[steps]


class Saving(BaseCallback):
    """Saves the policy at the first rollout after each `save_every` joint steps.

    Attributes:
        folder: Where to.
    """

    def __init__(self, config: Config, folder: Path) -> None:
        super().__init__()
        self._config, self.folder = config, folder

    def _on_rollout_start(self) -> None:
        done, update = self.model.num_timesteps, self._config.num_kitchens * self._config.rollout
        if done // self._config.save_every > (done - update) // self._config.save_every:
            save(self.model, done, self.folder, self._config)  # type: ignore[arg-type]

    def _on_step(self) -> bool:
        return True


def save(model: Learner, done: int, folder: Path, config: Config) -> None:
    """Saves the policy as it is after `done` joint steps; a run that goes on finds the same policy there."""
    if not policy_files(folder / str(done)).architecture.exists():
        freeze(folder / str(done), model, config)


def train(config: Config, place: Place) -> Outcome | None:
    """Trains, freezes and evaluates one policy; see `run` for the result and errors."""
    folder = place.folder / PAST
    made: list[PastSelves] = []

    def make(seed: int) -> Learner:
        partner = PastSelves(config, folder / str(seed))
        made.append(partner)
        model = make_learner(config, make_env(config, partners=[partner]), seed)
        save(model, 0, folder / str(seed), config)
        saving.folder = folder / str(seed)
        return model

    def before(joint_steps: int) -> None:
        episode = config.num_kitchens * config.horizon
        made[-1].next = joint_steps - joint_steps % episode

    saving = Saving(config, folder)
    return run(config, METHOD, place, make, callbacks=[saving], before=before)
