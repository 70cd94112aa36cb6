"""The first stage of a human proxy: one clone in one folder, trained once and read back afterwards."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import msgspec
import numpy as np
from safetensors.torch import load_model, save_model

from overcooked_bench.agents.policies.policy import PolicyFiles, policy_files

from ..learning.algorithms import make_learner
from ..learning.freeze import Returns, freeze, returns_with_itself
from ..learning.learner import Learner
from ..running.place import Place, read_record, write_record
from ..running.run import POLICY, make_env
from .bootstrap import Sample
from .clone import CloneSettings, fit
from .examples import Examples

RESULT: Final = "clone.json"
"""The outcome of cloning, in its folder; written last."""
LEARNER: Final = "learner.safetensors"
"""Actor and critic in full precision, from which PPO goes on."""


class _Result(msgspec.Struct):
    """What `clone.json` holds."""

    drawn: list[str]
    held_out: list[str]
    epochs: int
    nats: float
    steps: int
    seconds: float
    returns: list[float]


@dataclass(frozen=True)
class Clone:
    """A finished clone.

    Attributes:
        files: The frozen policy.
        learner: Actor and critic in full precision.
        sample: The pairs it learned from, and those it was held against.
        epochs: Passes over the examples that its weights have had.
        nats: Mean negative log-likelihood per step of the held-out pairs.
        steps: Joint steps of recorded play that it read, those of each pass counted.
        seconds: Wall-clock of cloning.
        returns: (E,) points of each episode with itself.
    """

    files: PolicyFiles
    learner: Path
    sample: Sample
    epochs: int
    nats: float
    steps: int
    seconds: float
    returns: Returns

    def restore(self, model: Learner) -> None:
        """Loads the weights into a fresh learner."""
        load_model(model.policy, self.learner)


def clone(settings: CloneSettings, place: Place, sample: Sample, rows: Examples) -> Clone:
    """Trains a clone that is not finished yet, and freezes it.

    Args:
        settings: What to train.
        place: Its own folder and seed.
        sample: Whom to learn from, and whom to be held against.
        rows: What all of them did.
    """
    found = read_record(place.folder / RESULT, _Result)
    if found is None:
        began = time.monotonic()
        model = make_learner(settings, make_env(settings, self_play=True), place.seed)
        drawn = rows.of(sample.drawn)
        fitted = fit(model.policy, drawn, rows.of(sample.held_out), settings, place.seed)
        seconds = time.monotonic() - began
        place.folder.mkdir(parents=True, exist_ok=True)
        files = freeze(place.folder / POLICY, model, settings)
        save_model(model.policy, str(place.folder / LEARNER))
        found = _Result(
            list(sample.drawn),
            list(sample.held_out),
            fitted.epochs,
            fitted.nats,
            fitted.epochs * len(drawn) // 2,
            round(seconds, 1),
            returns_with_itself(files, settings).tolist(),
        )
        write_record(place.folder / RESULT, msgspec.to_builtins(found))
    return Clone(
        policy_files(place.folder / POLICY),
        place.folder / LEARNER,
        Sample(tuple(found.drawn), tuple(found.held_out)),
        found.epochs,
        found.nats,
        found.steps,
        found.seconds,
        np.asarray(found.returns, np.float64),
    )
