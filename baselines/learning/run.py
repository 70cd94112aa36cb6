"""One training run in one folder: schedules, checkpoints, logs, restarts, the frozen policy at its end."""

import json
import os
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Final

import torch
from stable_baselines3.common.logger import Logger, make_output_format

from overcooked_bench.agents.policy import PolicyFiles, policy_files
from overcooked_bench.envs.sb3 import OvercookedVecEnv

from .checkpoint import CheckpointError, load_checkpoint, save_checkpoint
from .freeze import Returns, freeze, returns_with_itself
from .learner import Learner
from .monitor import Monitor, snapshot_name
from .networks import TrunkPolicy, policy_kwargs
from .pressure import Pressure
from .seeds import restarted
from .settings import Settings

CONFIG_FILE: Final = "config.json"
"""A run's resolved configuration, in its folder."""
CHECKPOINT: Final = "checkpoint.pt"
RESTARTS: Final = "restarts.json"
"""The attempts that the divergence check gave up, in a run's folder."""
POLICY: Final = "policy"
SNAPSHOTS: Final = "snapshots"


@dataclass(frozen=True)
class Outcome:
    """What a run brought.

    Attributes:
        files: The frozen policy's files, actor only, float16.
        returns: (E,) soup reward of each evaluation episode with itself, sampled actions, points.
        steps: Joint steps of training.
        seconds: Wall-clock of training in this process.
        snapshots: Policies saved on the way, by share of the steps.
        restarts: How often the divergence check began anew.
    """

    files: PolicyFiles
    returns: Returns
    steps: int
    seconds: float
    snapshots: dict[float, PolicyFiles] = field(default_factory=dict)
    restarts: int = 0


class UnfitError(ValueError):
    """The settings do not fit the layout, such as a standard start where the grid names no start cells."""


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


def make_learner(settings: Settings, env: OvercookedVecEnv, seed: int, pressure: Pressure | None = None) -> Learner:
    """Makes the learner of a run, untrained."""
    torch.set_num_threads(settings.threads)
    return Learner(
        TrunkPolicy,
        env,
        learning_rate=settings.learning_rate_at,
        n_steps=settings.rollout,
        batch_size=settings.learning_seats * settings.num_kitchens * settings.rollout // settings.minibatches,
        n_epochs=settings.epochs,
        gamma=settings.gamma,
        gae_lambda=settings.gae_lambda,
        clip_range=settings.clip,
        vf_coef=settings.value_coefficient,
        max_grad_norm=settings.max_grad_norm,
        policy_kwargs=policy_kwargs(settings),
        seed=seed,
        device=settings.device,
        pressure=pressure,
    )


def run(
    settings: Settings,
    method: str,
    output: Path,
    seed: int,
    make: Callable[[int], Learner],
    *,
    resume: bool = False,
    every: int = 250_000,
    told: dict[str, Any] | None = None,
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

    Returns:
        What came out, or None where the run was interrupted and saved.

    Raises:
        CheckpointError: There is nothing to resume from, or it belongs to another configuration.
        UnfitError: The settings do not fit the layout.
    """
    resolved = json.loads(json.dumps({**asdict(settings), **(told or {}), "method": method, "training_seed": seed}))
    checkpoint = output / CHECKPOINT
    given_up = _restarts(output) if resume else []
    seconds = 0.0
    while True:
        attempt = len(given_up)
        model = make(restarted(seed, attempt))
        config = resolved | ({"attempt": attempt} if attempt else {})
        going_on = resume and (checkpoint.exists() or not (output / CONFIG_FILE).exists())
        if going_on:  # a run that was killed before its first checkpoint begins anew
            load_checkpoint(checkpoint, model, config)
        output.mkdir(parents=True, exist_ok=True)
        _write(output / CONFIG_FILE, resolved)
        monitor = Monitor(
            config, checkpoint, every, settings, output / SNAPSHOTS, last_attempt=attempt >= settings.restarts
        )
        model.set_logger(_open_logs(output / "logs", monitor.joint_steps(model), attempt))
        began = time.perf_counter()
        try:
            rows = model.n_envs // settings.num_kitchens
            model.learn(rows * settings.steps - model.num_timesteps, monitor, reset_num_timesteps=not going_on)
        finally:
            monitor.close()
            model.logger.close()
        seconds += time.perf_counter() - began
        if monitor.diverged is None:
            break
        given_up.append({"seed": restarted(seed, attempt), **monitor.diverged})
        _write(output / RESTARTS, given_up)
        checkpoint.unlink(missing_ok=True)
        for file in (output / SNAPSHOTS).glob("*"):
            file.unlink()
    if monitor.stopped:
        return None
    save_checkpoint(checkpoint, model, config)
    files = freeze(output / POLICY, model.policy, settings)
    snapshots = {share: policy_files(output / SNAPSHOTS / snapshot_name(share)) for share in settings.snapshots}
    returns = returns_with_itself(files, settings)
    return Outcome(files, returns, monitor.joint_steps(model), seconds, snapshots, len(given_up))


def _restarts(output: Path) -> list[dict[str, Any]]:
    try:
        given_up: list[dict[str, Any]] = json.loads((output / RESTARTS).read_text())
    except FileNotFoundError:
        return []
    except ValueError as error:
        raise CheckpointError(f"{output / RESTARTS}: not JSON ({error}); choose another --output") from None
    return given_up


def _write(file: Path, content: Any) -> None:
    unfinished = file.with_suffix(".part")
    unfinished.write_text(json.dumps(content, indent=2) + "\n")
    os.replace(unfinished, file)


def _open_logs(folder: Path, done: int, attempt: int) -> Logger:
    """Logs for TensorBoard and as JSON lines; a run that goes on after `done` joint steps keeps its earlier logs."""
    suffix = (f"-restart-{attempt}" if attempt else "") + (f"-from-{done}" if done else "")
    return Logger(str(folder), [make_output_format(kind, str(folder), suffix) for kind in ("tensorboard", "json")])
