"""One training run in one folder: schedules, checkpoints, logs, restarts, the final frozen policy."""

import json
from collections.abc import Callable, Iterable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec
import numpy as np
import torch
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import Logger, make_output_format

from overcooked_bench.agents.policies.policy import PolicyError, PolicyFiles, load_policy, policy_files
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from overcooked_bench.errors import WrongUse

from ..learning.algorithms import AnyLearner
from ..learning.freeze import Returns, freeze, returns_with_itself
from ..learning.settings import Settings
from .checkpoint import check_same, load_checkpoint, save_checkpoint
from .monitor import Monitor, snapshot_name
from .place import CONFIG_FILE, CheckpointError, Place, read_record, write_record
from .seeds import restarted

CHECKPOINT: Final = "checkpoint.pt"
RESTARTS: Final = "restarts.json"
"""The attempts that the divergence check gave up, in a run's folder."""
RESULT: Final = "result.json"
"""The result of a finished run, in its folder."""
POLICY: Final = "policy"
SNAPSHOTS: Final = "snapshots"


class Snapshot(NamedTuple):
    """A policy saved on the way.

    Attributes:
        files: Its files.
        steps: Joint steps of training that it has had.
    """

    files: PolicyFiles
    steps: int


@dataclass(frozen=True)
class Outcome:
    """The result of a run.

    Attributes:
        files: The frozen policy's files, actor only, float16.
        returns: (E,) soup reward of each evaluation episode with itself, sampled actions, points.
        steps: Joint steps of training; those of attempts that the divergence check gave up do not count.
        seconds: Wall-clock of training, without pauses; that of the attempts given up counts.
        snapshots: Policies saved on the way, by share of the steps.
        restarts: How often the divergence check restarted it.
        with_partners: (E,) the same with the partners of the training, both seats; None where it had none of its own.
        parts: Outcomes of the other runs that this one consists of.
        legs: Outcomes among them that are of one policy, trained in so many runs one after the other.
    """

    files: PolicyFiles
    returns: Returns
    steps: int
    seconds: float
    snapshots: dict[float, Snapshot] = field(default_factory=dict)
    restarts: int = 0
    with_partners: Returns | None = None
    parts: tuple["Outcome", ...] = ()
    legs: int = 1

    @property
    def partner_runs(self) -> int:
        """Further policies that were trained for this one."""
        return len(self.parts) // self.legs

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


class _Result(msgspec.Struct):
    """What `result.json` holds; `snapshots` are the joint steps of each, by share of the steps."""

    steps: int
    seconds: float
    restarts: int
    returns: list[float]
    snapshots: dict[str, int] = {}


class _GivenUp(msgspec.Struct):
    """An attempt that the divergence check gave up, in `restarts.json`."""

    seed: int
    joint_steps: int
    soups: float
    seconds: float


def run(
    settings: Settings,
    method: str,
    place: Place,
    make: Callable[[int], AnyLearner],
    *,
    known: dict[str, Any] | None = None,
    callbacks: Sequence[BaseCallback] = (),
    before: Callable[[int], None] = lambda joint_steps: None,
) -> Outcome | None:
    """Trains, freezes and evaluates one policy.

    Args:
        settings: What to train.
        method: The method's name, for the records.
        place: Where the run is written, its seed, and whether to resume it.
        make: Makes the fresh learner with its kitchens for a seed.
        known: What else belongs to the resolved configuration, such as drawn weights or the partners' names.
        callbacks: Of stable-baselines3, called before our own.
        before: Called with the joint steps of a checkpoint before the kitchens are restored, so that partners can be
            made what they were.

    Returns:
        The result, or None if the run was interrupted and saved.

    Raises:
        CheckpointError: There is nothing to resume from, it is damaged, or it belongs to another configuration.
        UnfitError: The settings do not fit the layout, or there is no such device.
    """
    check_device(settings)
    torch.set_num_threads(settings.threads)  # also for what is measured after a run that was finished before
    resolved = resolved_config(settings, method, place.seed, known)
    output, checkpoint = place.folder, place.folder / CHECKPOINT
    given_up: list[_GivenUp] = []
    if place.resume:
        _check_config(output, resolved)
        if finished := _finished(output):
            return finished
        given_up = read_record(output / RESTARTS, list[_GivenUp]) or []
    while True:
        attempt = len(given_up)
        model = make(restarted(place.seed, attempt))
        config = resolved | ({"attempt": attempt} if attempt else {})
        going_on = place.resume and (checkpoint.exists() or not (output / CONFIG_FILE).exists())
        memory = None
        if going_on:  # a run that was killed before its first checkpoint starts again
            memory = load_checkpoint(checkpoint, model, config, before)
        output.mkdir(parents=True, exist_ok=True)
        write_record(output / CONFIG_FILE, resolved)
        last = attempt >= settings.restarts
        monitor = Monitor(config, checkpoint, place.every, settings, output / SNAPSHOTS, last, memory)
        _check_policies(output, [monitor.files(share) for share in monitor.saved])
        model.set_logger(_open_logs(output / "logs", monitor.joint_steps(model), attempt))
        try:
            rows = model.n_envs // settings.num_kitchens
            left = rows * settings.steps - model.num_timesteps
            model.learn(left, [*callbacks, monitor], reset_num_timesteps=not going_on)
        finally:
            monitor.close()
            model.logger.close()
        seconds = monitor.seconds + sum(one.seconds for one in given_up)
        if monitor.diverged is None:
            break
        checkpoint.unlink(missing_ok=True)
        for file in (output / SNAPSHOTS).glob("*"):
            file.unlink()
        given_up.append(_GivenUp(restarted(place.seed, attempt), *monitor.diverged, monitor.seconds))
        write_record(output / RESTARTS, msgspec.to_builtins(given_up))  # at last: a run killed before comes here again
        if monitor.asked:
            return None
    if monitor.stopped:
        return None
    save_checkpoint(checkpoint, model, config, monitor.memory())
    monitor.snap(settings.steps)  # shares that no rollout began after are the final policy's
    files = freeze(output / POLICY, model, settings)
    returns = returns_with_itself(files, settings)
    result = _Result(
        monitor.joint_steps(model),
        seconds,
        len(given_up),
        returns.tolist(),
        {str(share): monitor.saved[share] for share in settings.snapshots},
    )
    write_record(output / RESULT, msgspec.to_builtins(result))
    return None if monitor.asked else _outcome(output, result)  # asked in the last update: nothing else is started


def resolved_config(settings: Settings, method: str, seed: int, known: dict[str, Any] | None = None) -> dict[str, Any]:
    """Returns what a run's folder says about it, as it is read back from JSON."""
    content = {**asdict(settings), **(known or {}), "method": method, "training_seed": seed}
    if settings.people:
        content["people"] = settings.people
    plain: dict[str, Any] = json.loads(json.dumps(content, default=str))
    return plain


def claim(place: Place, settings: Settings, method: str, known: dict[str, Any] | None = None) -> None:
    """Writes the configuration of a run that consists of several into its folder.

    Raises:
        CheckpointError: The folder holds another one's.
        UnfitError: The settings do not fit the layout, or there is no such device.
    """
    check_device(settings)
    make_env(settings)
    resolved = resolved_config(settings, method, place.seed, known)
    if place.resume:
        _check_config(place.folder, resolved)
    place.folder.mkdir(parents=True, exist_ok=True)
    write_record(place.folder / CONFIG_FILE, resolved)


def check_device(settings: Settings) -> None:
    """Makes sure that there is the device to train on.

    Raises:
        UnfitError: There is none.
    """
    if settings.device == "cuda" and not torch.cuda.is_available():  # SB3 would take the processor without a word
        raise UnfitError("device='cuda', but torch finds no GPU here; give --device cpu")


def _check_config(output: Path, resolved: dict[str, Any]) -> None:
    known = read_record(output / CONFIG_FILE, dict[str, Any])
    if known is not None:
        check_same(output / CONFIG_FILE, known, resolved)


def _check_policies(output: Path, files: Iterable[PolicyFiles]) -> None:
    """Makes sure that policies which a run has saved are still there.

    Raises:
        CheckpointError: One is missing or damaged.
    """
    for one in files:
        try:
            load_policy(one.weights)
        except PolicyError as error:
            raise CheckpointError(
                f"{error}; the run in {output} had saved this policy: train it again with another --output"
            ) from None


def _finished(output: Path) -> Outcome | None:
    """Returns the result of a run that is finished already.

    Raises:
        CheckpointError: One of its policies is missing or damaged.
    """
    result = None
    with suppress(CheckpointError):  # a damaged one is written again
        result = read_record(output / RESULT, _Result)
    if result is None:
        return None
    outcome = _outcome(output, result)
    _check_policies(output, [outcome.files, *(one.files for one in outcome.snapshots.values())])
    return outcome


def _outcome(output: Path, result: _Result) -> Outcome:
    snapshots = {
        share: Snapshot(policy_files(output / SNAPSHOTS / snapshot_name(share)), steps)
        for share, steps in sorted((float(share), steps) for share, steps in result.snapshots.items())
    }
    returns = np.asarray(result.returns, np.float64)
    return Outcome(policy_files(output / POLICY), returns, result.steps, result.seconds, snapshots, result.restarts)


def _open_logs(folder: Path, done: int, attempt: int) -> Logger:
    """Opens logs for TensorBoard and as JSON lines; a run that goes on after `done` steps keeps its earlier logs."""
    suffix = (f"-restart-{attempt}" if attempt else "") + (f"-from-{done}" if done else "")
    return Logger(str(folder), [make_output_format(kind, str(folder), suffix) for kind in ("tensorboard", "json")])
