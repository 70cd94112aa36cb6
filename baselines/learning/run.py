"""One training run in one folder: schedules, checkpoints, logs, restarts, the frozen policy at its end."""

import json
import os
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final, TypedDict, TypeVar

import numpy as np
import torch
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger, make_output_format

from overcooked_bench import documents
from overcooked_bench.agents.policies.policy import PolicyFiles, policy_files
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import write_whole
from overcooked_bench.kitchen.layout import Layout

from .algorithms import AnyLearner
from .checkpoint import CheckpointError, check_same, load_checkpoint, save_checkpoint
from .freeze import Returns, freeze, returns_with_itself
from .monitor import Monitor, snapshot_name
from .seeds import restarted
from .settings import Settings

CONFIG_FILE: Final = "config.json"
"""A run's resolved configuration, in its folder."""
CHECKPOINT: Final = "checkpoint.pt"
RESTARTS: Final = "restarts.json"
"""The attempts that the divergence check gave up, in a run's folder."""
RESULT: Final = "result.json"
"""What a finished run brought, in its folder."""
SUMMARY: Final = "summary.json"
"""What a finished command brought, in its folder: points, steps and wall-clock of all its parts."""
MOST_BYTES: Final = 16 << 20
"""Of a JSON file in a run's folder."""
POLICY: Final = "policy"
SNAPSHOTS: Final = "snapshots"

T = TypeVar("T")


@dataclass(frozen=True)
class Outcome:
    """What a run brought.

    Attributes:
        files: The frozen policy's files, actor only, float16.
        returns: (E,) soup reward of each evaluation episode with itself, sampled actions, points.
        steps: Joint steps of training; those of attempts that the divergence check gave up do not count.
        seconds: Wall-clock of training, without pauses; that of the attempts given up counts.
        snapshots: Policies saved on the way, by share of the steps.
        restarts: How often the divergence check began anew.
        with_partners: (E,) the same with the partners of the training, both seats; None where it had none of its own.
        parts: Outcomes of the other runs that this one consists of.
    """

    files: PolicyFiles
    returns: Returns
    steps: int
    seconds: float
    snapshots: dict[float, PolicyFiles] = field(default_factory=dict)
    restarts: int = 0
    with_partners: Returns | None = None
    parts: tuple["Outcome", ...] = ()

    @property
    def total_steps(self) -> int:
        """Joint steps of this run and its parts."""
        return self.steps + sum(part.total_steps for part in self.parts)

    @property
    def total_restarts(self) -> int:
        """Restarts of this run and its parts."""
        return self.restarts + sum(part.total_restarts for part in self.parts)

    @property
    def total_seconds(self) -> float:
        """Wall-clock of training of this run and its parts, as if one after the other."""
        return self.seconds + sum(part.total_seconds for part in self.parts)


class _Result(TypedDict):
    """What `result.json` holds."""

    steps: int
    seconds: float
    restarts: int
    returns: list[float]


class UnfitError(WrongUse):
    """The settings do not fit the layout or the machine, as a standard start where the grid names no start cells."""


def make_env(settings: Settings, **others: Any) -> OvercookedVecEnv:
    """Makes the kitchens of a run.

    Args:
        settings: The run's.
        others: Further arguments of `OvercookedVecEnv`, such as `partners` or `self_play`.

    Raises:
        UnfitError: Kitchens cannot be made so.
    """
    try:
        return OvercookedVecEnv(
            settings.layout,
            settings.num_kitchens,
            observation=settings.observation,
            cooking=settings.cooking,
            start=settings.start,
            object_probability=settings.object_probability,
            horizon=settings.horizon,
            **others,
        )
    except ValueError as error:
        raise UnfitError(str(error)) from error


def run(
    settings: Settings,
    method: str,
    output: Path,
    seed: int,
    make: Callable[[int], AnyLearner],
    *,
    resume: bool = False,
    every: int = 250_000,
    told: dict[str, Any] | None = None,
    callbacks: Sequence[BaseCallback] = (),
    before: Callable[[int], None] = lambda joint_steps: None,
) -> Outcome | None:
    """Trains, freezes and evaluates one policy.

    Args:
        settings: What to train.
        method: The method's name, for the records.
        output: Folder for the checkpoint, the logs, the resolved configuration and the frozen policy.
        seed: Of all random numbers.
        make: Makes the fresh learner with its kitchens for a seed.
        resume: Whether to go on from the folder's checkpoint; the weights are those of an uninterrupted run.
        every: Joint steps between checkpoints.
        told: What else belongs to the resolved configuration, such as drawn weights or the partners' names.
        callbacks: Of stable-baselines3, called before our own.
        before: Told the joint steps of a checkpoint before the kitchens are restored, so that partners can be made
            what they were.

    Returns:
        What came out, or None where the run was interrupted and saved.

    Raises:
        CheckpointError: There is nothing to resume from, or it belongs to another configuration.
        UnfitError: The settings do not fit the layout, or there is no such device.
    """
    _check_device(settings)
    torch.set_num_threads(settings.threads)  # also for what is measured after a run that was finished before
    resolved = resolved_config(settings, method, seed, told)
    checkpoint = output / CHECKPOINT
    if resume:
        _check_config(output, resolved)
        if known := _finished(output, settings):
            return known
    given_up = (read_json(output / RESTARTS, list[dict[str, int | float]]) or []) if resume else []
    while True:
        attempt = len(given_up)
        model = make(restarted(seed, attempt))
        config = resolved | ({"attempt": attempt} if attempt else {})
        going_on = resume and (checkpoint.exists() or not (output / CONFIG_FILE).exists())
        memory = None
        if going_on:  # a run that was killed before its first checkpoint begins anew
            memory = load_checkpoint(checkpoint, model, config, before)
        output.mkdir(parents=True, exist_ok=True)
        write_json(output / CONFIG_FILE, resolved)
        last = attempt >= settings.restarts
        monitor = Monitor(config, checkpoint, every, settings, output / SNAPSHOTS, last, memory)
        model.set_logger(_open_logs(output / "logs", monitor.joint_steps(model), attempt))
        try:
            rows = model.n_envs // settings.num_kitchens
            left = rows * settings.steps - model.num_timesteps
            model.learn(left, [*callbacks, monitor], reset_num_timesteps=not going_on)
        finally:
            monitor.close()
            model.logger.close()
        seconds = monitor.seconds + sum(one.get("seconds", 0.0) for one in given_up)
        if monitor.diverged is None:
            break
        checkpoint.unlink(missing_ok=True)
        for file in (output / SNAPSHOTS).glob("*"):
            file.unlink()
        given_up.append({"seed": restarted(seed, attempt), **monitor.diverged, "seconds": monitor.seconds})
        write_json(output / RESTARTS, given_up)  # at last: a run killed before comes to this point again
        if monitor.asked:
            return None
    if monitor.stopped:
        return None
    save_checkpoint(checkpoint, model, config, monitor.memory())
    monitor.snap(settings.steps)  # shares that no rollout began after are the final policy's
    files = freeze(output / POLICY, model, settings)
    returns = returns_with_itself(files, settings)
    outcome = Outcome(files, returns, monitor.joint_steps(model), seconds, _snapshots(output, settings), len(given_up))
    numbers = {"steps": outcome.steps, "seconds": seconds, "restarts": outcome.restarts, "returns": returns.tolist()}
    write_json(output / RESULT, numbers)
    return None if monitor.asked else outcome  # asked in the last update: nothing else is to be begun


def label(layout: str) -> str:
    """Gives a layout's name as a folder can have it: "custom" where it is a grid."""
    name = Layout.load(layout).name
    return "custom" if "\n" in name else name


def resolved_config(settings: Settings, method: str, seed: int, told: dict[str, Any] | None = None) -> dict[str, Any]:
    """Gives what a run's folder says about it, as it is read back from JSON."""
    content = {**asdict(settings), **(told or {}), "method": method, "training_seed": seed}
    plain: dict[str, Any] = json.loads(json.dumps(content, default=str))
    return plain


def claim(output: Path, settings: Settings, method: str, seed: int, resume: bool) -> None:
    """Writes the configuration of a run that consists of several into its folder.

    Raises:
        CheckpointError: The folder holds another one's.
        UnfitError: The settings do not fit the layout, or there is no such device.
    """
    _check_device(settings)
    make_env(settings)
    resolved = resolved_config(settings, method, seed)
    if resume:
        _check_config(output, resolved)
    output.mkdir(parents=True, exist_ok=True)
    write_json(output / CONFIG_FILE, resolved)


def write_json(file: Path, content: Any) -> None:
    """Writes a JSON file whole or not at all."""
    write_whole(file, json.dumps(content, indent=2) + "\n")


def read_json(file: Path, kind: type[T]) -> T | None:
    """Reads a JSON file that a run may have been killed before writing.

    Args:
        file: The file.
        kind: What it holds.

    Returns:
        The content, or None if there is no such file.

    Raises:
        CheckpointError: It is not JSON, or holds something else.
    """
    if not os.path.lexists(file):
        return None
    try:
        return documents.read_json(file, MOST_BYTES, kind)
    except WrongUse as error:
        raise CheckpointError(f"{error}; restore the file, or choose another --output") from None


def _check_device(settings: Settings) -> None:
    if settings.device == "cuda" and not torch.cuda.is_available():  # SB3 would take the processor without a word
        raise UnfitError("device='cuda', but torch finds no GPU here; give --device cpu")


def _check_config(output: Path, resolved: dict[str, Any]) -> None:
    known = read_json(output / CONFIG_FILE, dict[str, Any])
    if known is not None:
        check_same(output / CONFIG_FILE, known, resolved)


def _snapshots(output: Path, settings: Settings) -> dict[float, PolicyFiles]:
    return {share: policy_files(output / SNAPSHOTS / snapshot_name(share)) for share in settings.snapshots}


def _finished(output: Path, settings: Settings) -> Outcome | None:
    """Gives the outcome of a run that is finished already."""
    with suppress(CheckpointError):  # a damaged one is written again
        if numbers := read_json(output / RESULT, _Result):
            returns = np.asarray(numbers["returns"], np.float64)
            files, snapshots = policy_files(output / POLICY), _snapshots(output, settings)
            return Outcome(files, returns, numbers["steps"], numbers["seconds"], snapshots, numbers["restarts"])
    return None


def _open_logs(folder: Path, done: int, attempt: int) -> Logger:
    """Logs for TensorBoard and as JSON lines; a run that goes on after `done` joint steps keeps its earlier logs."""
    suffix = (f"-restart-{attempt}" if attempt else "") + (f"-from-{done}" if done else "")
    return Logger(str(folder), [make_output_format(kind, str(folder), suffix) for kind in ("tensorboard", "json")])
