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
from stable_baselines3.common.base_class import BaseAlgorithm
from stable_baselines3.common.callbacks import BaseCallback

from overcooked_bench.agents.policies.policy import PolicyFiles, policy_files
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from overcooked_bench.kitchen.layout import Layout

from ..learning.freeze import freeze
from ..learning.settings import Settings
from .checkpoint import save_checkpoint

_RECENT = 100
_SECONDS_BETWEEN_LINES = 30


class Monitor(BaseCallback):
    """Sets the schedules before each rollout, saves there, and shows how the run is doing.

    The first Ctrl-C lets the rollout and its update come to an end, saves, and stops; the second one stops at once.

    Args:
        config: The run's resolved configuration.
        checkpoint: Where to save, every `every` joint steps, and when the run is stopped.
        every: Joint steps between checkpoints.
        settings: The run's.
        snapshots: Folder for the policies that are saved on the way.
        last_attempt: Whether the run goes on though the divergence check finds it wanting.
        memory: What `memory` gave when the run was saved; none for a fresh run.

    Attributes:
        asked: Whether Ctrl-C was pressed.
        stopped: Whether the run was stopped, and saved, before its end.
        diverged: What the divergence check found where it gave the run up, else None.
    """

    def __init__(
        self,
        config: dict[str, Any],
        checkpoint: Path,
        every: int,
        settings: Settings,
        snapshots: Path,
        last_attempt: bool = True,
        memory: dict[str, Any] | None = None,
    ) -> None:
        super().__init__()
        self._config, self._checkpoint, self._every, self._settings = config, checkpoint, every, settings
        known = {"returns": [], "unchecked": True, "seconds": 0.0, "snapshots": {}, **(memory or {})}
        self._snapshots = snapshots
        self.saved = {float(share): int(steps) for share, steps in known["snapshots"].items()}
        self._unchecked = settings.check_share > 0 and not last_attempt and known["unchecked"]
        self._began, self._before = time.monotonic(), float(known["seconds"])
        self._steps = settings.steps
        self._returns: deque[float] = deque(known["returns"], maxlen=_RECENT)
        self._soup_points = Layout.load(settings.layout).soup_points
        self._name = "custom kitchen" if "\n" in settings.layout else settings.layout
        self._answered = False
        self._restore: Callable[[], object] = lambda: None
        self._console = Console(stderr=True)
        self._progress = Progress(
            TextColumn("{task.description}"),
            BarColumn(),
            TextColumn("{task.fields[told]}"),
            TimeElapsedColumn(),
            TextColumn("left"),
            TimeRemainingColumn(),
            console=self._console,
            disable=not self._console.is_terminal,
        )
        self.asked = self.stopped = False
        self.diverged: tuple[int, float] | None = None

    def joint_steps(self, model: BaseAlgorithm) -> int:
        """Joint steps that a learner has done; SB3 counts those of every row."""
        return model.num_timesteps // (model.n_envs // self._settings.num_kitchens)

    def memory(self) -> dict[str, Any]:
        """Returns what the divergence check depends on, and the time, for a checkpoint."""
        return {
            "returns": list(self._returns),
            "unchecked": self._unchecked,
            "seconds": self.seconds,
            "snapshots": {str(share): steps for share, steps in self.saved.items()},
        }

    @property
    def seconds(self) -> float:
        """Wall-clock of training, without pauses."""
        return self._before + time.monotonic() - self._began

    def close(self) -> None:
        """Restores Ctrl-C and the terminal; needed after a run that ended by an exception, harmless after others."""
        self._progress.stop()
        self._restore()
        self._restore = lambda: None

    def _on_training_start(self) -> None:
        try:
            before = signal.signal(signal.SIGINT, self._interrupt)
            self._restore = lambda: signal.signal(signal.SIGINT, before)
        except ValueError:  # not in the main thread: nobody types Ctrl-C there
            pass
        self._saved_at = self._first = self._done
        self._began = self._told = time.monotonic()
        self._task = self._progress.add_task(self._name, total=self._steps, completed=self._done, told="")
        self._progress.start()

    def _on_rollout_start(self) -> None:
        done = self._done
        self.stopped = self.asked
        if self.stopped or done - self._saved_at >= self._every:
            save_checkpoint(self._checkpoint, self.model, self._config, self.memory())  # type: ignore[arg-type]
            self._saved_at = done
        self._check(done)
        self.snap(done)
        self._env.set_shaping(self._settings.shaping_at(done))
        self._env.set_event_share(self._settings.event_share_at(done))
        self.model.ent_coef = self._settings.entropy_at(done)  # type: ignore[attr-defined]
        self._tell(done)

    def _on_step(self) -> bool:
        if self.asked and not self._answered:
            self._answered = True
            self._console.print("stopping and saving after this update; Ctrl-C again stops at once")
        if self.locals["dones"][0]:
            self._returns.extend(info["episode_soup_reward"] for info in self.locals["infos"][:: self._rows])
        return not self.stopped and self.diverged is None

    def _on_rollout_end(self) -> None:
        if self._returns:
            self.logger.record("rollout/soup_reward", float(np.mean(self._returns)))
        self.logger.record("train/joint_steps", self._done)

    def _on_training_end(self) -> None:
        done = self._saved_at if self.stopped else self._done  # a stop costs one more step, which is forgotten
        if self.logger.name_to_value:  # the last update's
            self.logger.record("train/joint_steps", done)
            self.logger.dump(done * self._rows)
        self._tell(done, last=True)
        self.close()

    def _check(self, done: int) -> None:
        """Abandons a run that has not learned to deliver (thesis, chapter 6: preemptive divergence check)."""
        if not self._unchecked or done < self._settings.check_share * self._steps or not self._returns:
            return
        self._unchecked = False
        soups = float(np.mean(self._returns)) / self._soup_points
        if soups < self._settings.check_soups:
            self.diverged = done, soups
            self._console.print(f"{soups:.1f} soups per episode after {done:,} steps; restarting with a new seed")

    def snap(self, done: int) -> None:
        """Saves the policy where a share of the steps has passed.

        Args:
            done: Joint steps; the whole run's to save what no rollout began after.
        """
        for share in self._settings.snapshots:
            if done >= share * self._steps and share not in self.saved:
                freeze(self._snapshots / snapshot_name(share), self.model, self._settings)
                self.saved[share] = self._done

    def files(self, share: float) -> PolicyFiles:
        """Returns the files of a snapshot."""
        return policy_files(self._snapshots / snapshot_name(share))

    @property
    def _env(self) -> OvercookedVecEnv:
        assert isinstance(self.training_env, OvercookedVecEnv)
        return self.training_env

    @property
    def _done(self) -> int:
        return self.joint_steps(self.model)

    @property
    def _rows(self) -> int:
        """Rows of the batch that a kitchen has."""
        return self._env.num_envs // self._env.kitchens.num_kitchens

    def _tell(self, done: int, last: bool = False) -> None:
        now = time.monotonic()
        rate = (done - self._first) / max(now - self._began, 1e-9)
        told = f"{rate:7.0f} steps/s"
        if self._returns:
            mean = float(np.mean(self._returns))
            told = f"return {mean:5.1f}  soups {mean / self._soup_points:4.1f}  {told}"
        self._progress.update(self._task, completed=done, told=told)
        if self._progress.disable and (last or now - self._told > _SECONDS_BETWEEN_LINES):
            self._told = now
            left = f"  {max(0, self._steps - done) / rate:.0f} s left" if rate else ""
            print(f"{self._name}: {done:,} of {self._steps:,} steps  {told}{left}", flush=True)

    def _interrupt(self, number: int, frame: FrameType | None) -> None:
        if self.asked:
            raise KeyboardInterrupt
        self.asked = True


def snapshot_name(share: float) -> str:
    """Returns the stem of a snapshot's files."""
    return f"at-{share:g}"
