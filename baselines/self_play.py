"""Self-play: one policy on both seats learns from both seats' experience.

Source: Carroll et al. 2019 (self-play PPO on the lossless encoding, partial rewards annealed to zero); random starts
and an annealed entropy bonus after the thesis, 6.1 and Table 6.1. Network and sizes are our own: small and quick.
"""

import json
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import torch
import tyro
from stable_baselines3 import PPO
from stable_baselines3.common.logger import Logger, make_output_format

from overcooked_bench.agents.neural import NeuralAgent
from overcooked_bench.agents.policy import PolicyFiles, load_policy, save_policy
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from overcooked_bench.evaluation.play import play_episodes
from overcooked_bench.evaluation.statistics import t_interval
from overcooked_bench.kitchen.layout import Layout, LayoutError

from .checkpoint import CheckpointError, load_checkpoint, save_checkpoint
from .inputs import live_inputs
from .monitor import Monitor
from .seeds import USER, derive_seed
from .trunk import TrunkPolicy, frozen_actor, policy_kwargs

METHOD = "self-play"
CONFIG_FILE = "config.json"
"""A run's resolved configuration, in its folder."""
_STOPPED = 130


@dataclass(frozen=True)
class SelfPlay:
    """Trains one policy on both seats of a kitchen."""

    layout: str
    """Shipped layout, grid text or `.layout` file."""
    seed: int = 0
    """Which of your runs this is; the generator's seed is a hash of it with layout and method."""
    steps: int = 1_600_000
    """Joint steps of training."""
    num_kitchens: int = 64
    """Kitchens that are played at the same time."""
    rollout: int = 200
    """Steps of each kitchen between updates."""
    epochs: int = 4
    """Passes over a rollout."""
    minibatches: int = 4
    """Parts that a pass is cut into."""
    learning_rate: float = 1e-3
    """Of Adam at the start; falls linearly to 0."""
    gamma: float = 0.99
    """Discount of a step."""
    gae_lambda: float = 0.95
    """Generalised advantage estimation."""
    clip: float = 0.2
    """PPO's clipping range."""
    value_coefficient: float = 0.05
    """Weight of the critic's loss; at 0.5 its gradient, clipped with the actor's, leaves the actor standing."""
    max_grad_norm: float = 0.5
    """Longest gradient."""
    entropy_start: float = 0.03
    """Coefficient of the entropy bonus at the start; changes linearly."""
    entropy_end: float = 0.01
    """Coefficient of the entropy bonus at the end."""
    shaping_share: float = 2 / 3
    """Share of the steps after which partial rewards have faded, linearly, to nothing."""
    hidden: tuple[int, ...] = (128, 128)
    """Width of the layers that actor and critic share."""
    observation: Literal["lossless", "lossless26", "stack_channels", "stack_states"] = "lossless"
    """What the policy sees."""
    cooking: Literal["auto", "manual"] = "auto"
    """Cooking mode."""
    start: Literal["random", "standard"] = "random"
    """Start states."""
    horizon: int = 400
    """Steps of an episode."""

    def __post_init__(self) -> None:
        """Refuses what PPO cannot be run with.

        Raises:
            ValueError: Names the setting and what it may be.
        """
        for name in ("num_kitchens", "rollout", "epochs", "minibatches", "horizon"):
            if getattr(self, name) < 1:
                raise ValueError(f"{name}={getattr(self, name)}; give a number from 1")
        update = self.num_kitchens * self.rollout
        if self.steps < 2 * update:
            raise ValueError(f"steps={self.steps}; give at least two updates, {2 * update} joint steps")
        if (2 * update) % self.minibatches or 2 * update == self.minibatches:
            raise ValueError(
                f"minibatches={self.minibatches}; give a divisor of the {2 * update} steps of both chefs in an update"
            )
        if not self.hidden or min(self.hidden) < 1:
            raise ValueError(f"hidden={self.hidden}; give the width of each layer, from 1")


@dataclass(frozen=True)
class Outcome:
    """What a run brought.

    Attributes:
        files: The frozen policy's files, actor only, float16.
        returns: (E,) soup reward of each evaluation episode with itself, sampled actions, points.
        steps: Joint steps of training.
        seconds: Wall-clock of training in this process.
    """

    files: PolicyFiles
    returns: np.ndarray[tuple[int], np.dtype[np.float64]]
    steps: int
    seconds: float


class UnfitError(ValueError):
    """The settings do not fit the layout, such as a standard start where the grid names no start cells."""


def make_learner(config: SelfPlay, seed: int) -> PPO:
    """Makes the learner with its kitchens, on one core.

    Raises:
        UnfitError: Kitchens cannot be made so.
    """
    torch.set_num_threads(1)
    try:
        env = OvercookedVecEnv(
            config.layout,
            config.num_kitchens,
            self_play=True,
            observation=config.observation,
            cooking=config.cooking,
            start=config.start,
            horizon=config.horizon,
        )
    except ValueError as error:
        raise UnfitError(str(error)) from error
    return PPO(
        TrunkPolicy,
        env,
        learning_rate=lambda left: config.learning_rate * max(0.0, left),  # the last rollout may end after `steps`
        n_steps=config.rollout,
        batch_size=2 * config.num_kitchens * config.rollout // config.minibatches,
        n_epochs=config.epochs,
        gamma=config.gamma,
        gae_lambda=config.gae_lambda,
        clip_range=config.clip,
        vf_coef=config.value_coefficient,
        max_grad_norm=config.max_grad_norm,
        policy_kwargs=policy_kwargs(live_inputs(env.kitchens.layout, config.observation), config.hidden),
        seed=seed,
        device="cpu",
    )


def train(config: SelfPlay, output: Path, seed: int, *, resume: bool = False, every: int = 250_000) -> Outcome | None:
    """Trains, freezes and evaluates one policy.

    Args:
        config: What to train.
        output: Folder for the checkpoint, the logs, the resolved configuration and the frozen policy.
        seed: Of all random numbers.
        resume: Whether to go on from the folder's checkpoint; the weights are those of an uninterrupted run.
        every: Joint steps between checkpoints.

    Returns:
        What came out, or None where the run was interrupted and saved.

    Raises:
        CheckpointError: There is nothing to resume from, or it belongs to another configuration.
        UnfitError: The settings do not fit the layout.
    """
    resolved = {**json.loads(json.dumps(asdict(config))), "method": METHOD, "training_seed": seed}
    checkpoint = output / "checkpoint.pt"
    model = make_learner(config, seed)
    if resume:
        load_checkpoint(checkpoint, model, resolved)
    output.mkdir(parents=True, exist_ok=True)
    (output / CONFIG_FILE).write_text(json.dumps(resolved, indent=2) + "\n")
    faded = max(1.0, config.shaping_share * config.steps)
    monitor = Monitor(
        resolved,
        checkpoint,
        every,
        config.steps,
        shaping=lambda done: max(0.0, 1 - done / faded),
        entropy=lambda done: config.entropy_start + (config.entropy_end - config.entropy_start) * done / config.steps,
    )
    model.set_logger(_open_logs(output / "logs", model.num_timesteps // 2))
    began = time.perf_counter()
    try:
        model.learn(2 * config.steps - model.num_timesteps, callback=monitor, reset_num_timesteps=not resume)
    finally:
        monitor.close()
        model.logger.close()
    seconds = time.perf_counter() - began
    if monitor.stopped:
        return None
    save_checkpoint(checkpoint, model, resolved)
    layout = Layout.load(config.layout).name
    architecture, weights = frozen_actor(model.policy, config.observation, layout, config.cooking, config.hidden)
    files = save_policy(output / "policy", architecture, weights)
    returns = evaluate(files, config)
    return Outcome(files, returns, model.num_timesteps // 2, seconds)


def _open_logs(folder: Path, done: int) -> Logger:
    """Logs for TensorBoard and as JSON lines; a run that goes on after `done` joint steps keeps its earlier logs."""
    suffix = f"-from-{done}" if done else ""
    return Logger(str(folder), [make_output_format(kind, str(folder), suffix) for kind in ("tensorboard", "json")])


def evaluate(files: PolicyFiles, config: SelfPlay, episodes: int = 100) -> np.ndarray[tuple[int], np.dtype[np.float64]]:
    """Plays a frozen policy with itself: (episodes,) soup reward, sampled actions, in points."""
    pair = tuple(NeuralAgent(load_policy(files.weights)) for _ in range(2))
    games = play_episodes(
        config.layout,
        agents=(pair[0], pair[1]),
        episodes=episodes,
        cooking=config.cooking,
        start=config.start,
        horizon=config.horizon,
    )
    return np.asarray(games.soup_reward, np.float64)


@dataclass(frozen=True)
class _Run(SelfPlay):
    output: Annotated[Path | None, tyro.conf.arg(aliases=["-o"])] = None
    """Folder for everything; runs/self-play-<layout>-<seed> by default."""
    resume: bool = False
    """Go on from the folder's checkpoint."""
    checkpoint_every: int = 250_000
    """Joint steps between checkpoints."""


def main(arguments: list[str]) -> int:
    """Runs `overcooked-bench train self-play ...`; gives the exit code: 0, 2 for wrong use, 130 after Ctrl-C."""
    run = tyro.cli(_Run, args=arguments, prog="overcooked-bench train self-play", description=_HELP)
    try:
        name = Layout.load(run.layout).name
        label = name if "\n" not in name else "custom"
        output = run.output or Path("runs") / f"{METHOD}-{label}-{run.seed}"
        config = SelfPlay(**{key: getattr(run, key) for key in SelfPlay.__dataclass_fields__})
        seed = derive_seed(USER, name, METHOD, run.seed)
        if (output / "checkpoint.pt").exists() and not run.resume:
            raise CheckpointError(
                f"{output} holds a run already; go on with it by --resume, or choose another --output"
            )
        outcome = train(config, output, seed, resume=run.resume, every=run.checkpoint_every)
    except (LayoutError, CheckpointError, UnfitError) as error:
        print(f"overcooked-bench train: {error}", file=sys.stderr)
        return 2
    if outcome is None:
        print(f"stopped, and saved in {output}; the same command with --resume goes on from there", file=sys.stderr)
        return _STOPPED
    mean, low, high = t_interval(outcome.returns)
    print(
        f"{outcome.files.weights}: return with itself {mean:.1f} "
        f"[{low:.1f}, {high:.1f}] points over {len(outcome.returns)} episodes, after {outcome.steps:,} joint steps "
        f"in {outcome.seconds:.0f} s"
    )
    return 0


_HELP = """Trains one policy on both seats of a kitchen by PPO.

Example: overcooked-bench train self-play --layout forced_coordination --seed 1
"""

if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
