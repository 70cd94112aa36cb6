"""What happens between the steps of a training run: schedules, checkpoints, progress, a clean stop."""

import signal
import time
from collections import deque
from collections.abc import Callable
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
from rich.console import Console
from rich.progress import BarColumn, Progress, TextColumn, TimeElapsedColumn, TimeRemainingColumn
from stable_baselines3.common.callbacks import BaseCallback

from overcooked_bench.baselines.checkpoint import save_checkpoint
from overcooked_bench.envs.sb3 import OvercookedVecEnv

_RECENT = 100
_SECONDS_BETWEEN_LINES = 30


class Monitor(BaseCallback):
    """Sets the schedules before each rollout, saves there, and shows how the run is doing.

    Args:
        config: The run's resolved configuration.
        checkpoint: Where to save, every `every` joint steps, and when the run is interrupted.
        every: Joint steps between checkpoints.
        steps: Joint steps of the whole run.
        shaping: Weight of the partial rewards by joint steps done.
        entropy: Coefficient of the entropy bonus by joint steps done.
    """

    def __init__(
        self,
        config: dict[str, Any],
        checkpoint: Path,
        every: int,
        steps: int,
        shaping: Callable[[int], float],
        entropy: Callable[[int], float],
    ) -> None:
        super().__init__()
        self._config, self._checkpoint, self._every, self._steps = config, checkpoint, every, steps
        self._shaping, self._entropy = shaping, entropy
        self._saved_at = -1
        self._returns: deque[float] = deque(maxlen=_RECENT)
        self.interrupted = False

    def _on_training_start(self) -> None:
        self._before = signal.getsignal(signal.SIGINT)
        try:
            signal.signal(signal.SIGINT, self._interrupt)
        except ValueError:  # not in the main thread: nobody types Ctrl-C there
            self._before = None
        self._saved_at = self._first = self._done
        self._began = self._told = time.monotonic()
        console = Console(stderr=True)
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[told]}"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
            console=console,
            disable=not console.is_terminal,
        )
        self._task = self._progress.add_task(self._config["layout"], total=self._steps, told="")
        self._progress.start()

    def _on_rollout_start(self) -> None:
        done = self._done
        if done - self._saved_at >= self._every or self.interrupted:
            save_checkpoint(self._checkpoint, self.model, self._config)  # type: ignore[arg-type]
            self._saved_at = done
        assert isinstance(self.training_env, OvercookedVecEnv)
        self.training_env.set_shaping(self._shaping(done))
        self.model.ent_coef = self._entropy(done)  # type: ignore[attr-defined]
        self._tell(done)

    def _on_step(self) -> bool:
        if self.locals["dones"][0]:
            self._returns.extend(info["episode_soup_reward"] for info in self.locals["infos"][::2])
        return not self.interrupted

    def _on_training_end(self) -> None:
        self._tell(self._done, last=True)
        self._progress.stop()
        if self._before is not None:
            signal.signal(signal.SIGINT, self._before)

    @property
    def _done(self) -> int:
        """Joint steps so far; SB3 counts each seat's."""
        return self.num_timesteps_joint

    @property
    def num_timesteps_joint(self) -> int:
        """Joint steps that the learner has seen."""
        assert isinstance(self.training_env, OvercookedVecEnv)
        return int(self.model.num_timesteps) * self.training_env.kitchens.num_kitchens // self.training_env.num_envs

    def _tell(self, done: int, last: bool = False) -> None:
        now = time.monotonic()
        rate = (done - self._first) / max(now - self._began, 1e-9)
        mean = float(np.mean(self._returns)) if self._returns else 0.0
        self.logger.record("rollout/soup_reward", mean)
        self.logger.record("train/joint_steps", done)
        told = f"return {mean:5.1f}  soups {mean / 20:4.1f}  {rate:7.0f} steps/s"
        self._progress.update(self._task, completed=done, told=told)
        if self._progress.disable and (last or now - self._told > _SECONDS_BETWEEN_LINES):
            self._told = now
            left = (self._steps - done) / max(rate, 1e-9)
            print(f"{self._config['layout']}: {done:,} of {self._steps:,} steps  {told}  {left:.0f} s left", flush=True)

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        """Asks for a stop at the next rollout; a second Ctrl-C stops at once."""
        if self.interrupted:
            raise KeyboardInterrupt
        self.interrupted = True
