"""The first stage of a human proxy: one clone in one folder, trained once and read back afterwards."""

import time
from dataclasses import dataclass
from pathlib import Path
from typing import Final

import msgspec
import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn
from safetensors import SafetensorError
from safetensors.torch import load_model, save_model

from overcooked_bench.agents.policies.policy import PolicyFiles, load_policy, policy_files

from ..learning.algorithms import make_learner
from ..learning.freeze import Returns, freeze, returns_with_itself
from ..learning.learner import Learner
from ..running.place import CheckpointError, Place, read_record, write_record
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
        """Loads the weights into a fresh learner.

        Raises:
            CheckpointError: They are missing, damaged, or those of another network.
        """
        try:
            load_model(model.policy, self.learner)
        except (OSError, SafetensorError, RuntimeError) as error:
            fault = str(error).partition("\n")[0]
            raise CheckpointError(
                f"{self.learner}: missing, damaged, or of another network ({fault}); choose another --output"
            ) from None


def clone(settings: CloneSettings, place: Place, sample: Sample, rows: Examples) -> Clone:
    """Trains a clone that is not finished yet, and freezes it.

    Args:
        settings: What to train.
        place: Its own folder and seed.
        sample: Whom to learn from, and whom to be held against.
        rows: What all of them did.

    Raises:
        CheckpointError: The folder holds a clone of other people, or a damaged one.
        PolicyError: Its frozen policy is missing or damaged.
    """
    found = read_record(place.folder / RESULT, _Result)
    if found is not None:
        _check(place, found, sample)
    if found is None:
        began = time.monotonic()
        model = make_learner(settings, make_env(settings, self_play=True), place.seed)
        drawn = rows.of(sample.drawn)
        with _bar() as bar:
            task = bar.add_task(
                f"cloning, in {settings.clone_epochs} passes at most", total=settings.clone_epochs, nats=""
            )
            fitted = fit(
                model.policy,
                drawn,
                rows.of(sample.held_out),
                settings,
                place.seed,
                lambda epoch, nats: bar.update(task, completed=epoch, nats=f"{nats:.3f} nats"),
            )
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


def _bar() -> Progress:
    """Makes the progress bar, which only a terminal shows."""
    console = Console(stderr=True)
    columns = TextColumn("{task.description}"), BarColumn(), TextColumn("{task.fields[nats]}"), TimeElapsedColumn()
    return Progress(*columns, console=console, disable=not console.is_terminal)


def _check(place: Place, found: _Result, sample: Sample) -> None:
    """Makes sure that a finished clone is the one that is wanted, and still there."""
    if (tuple(found.drawn), tuple(found.held_out)) != sample:
        raise CheckpointError(
            f"{place.folder / RESULT}: a clone of {', '.join(found.drawn)}, not of {', '.join(sample.drawn)}; "
            "choose another --output"
        )
    load_policy(place.folder / POLICY)
