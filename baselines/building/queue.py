"""The queue behind `overcooked-bench pool build`: parallel training runs, each in its own process.

The first Ctrl-C (or SIGTERM) lets every run finish its update, saves, and stops; the second one ends them at once. Runs
whose queue was killed notice it and stop by themselves. What a run prints is in `log.txt` in its folder.
"""

import os
import signal
import sys
import time
import traceback
from collections import deque
from collections.abc import Callable, Sequence
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass, field
from functools import partial
from multiprocessing.connection import wait
from multiprocessing.context import SpawnProcess
from pathlib import Path
from typing import Any, Final, Protocol, TypeVar

from overcooked_bench.agents.pools.manifest import PoolError
from overcooked_bench.processes import follow_parent, hold_stops, listen, start_process

from ..running.locks import locked
from .build import AGENTS_FILE, PoolBuildError, publish, train_run
from .config import Run

LOG: Final = "log.txt"
_DONE, _FAILED, _STOPPED, _TAKEN = 0, 1, 130, 75

Report = Callable[[str], None]


@dataclass
class Result:
    """What became of the runs, or of other jobs.

    Attributes:
        finished: Names of those that are in the pool now.
        failed: Names of those that ended by an error.
        taken: Names of those that another build is at.
        stopped: Whether the queue was stopped before its end.
    """

    finished: list[str] = field(default_factory=list)
    failed: list[str] = field(default_factory=list)
    taken: list[str] = field(default_factory=list)
    stopped: bool = False

    @property
    def well(self) -> bool:
        """Whether all went well: every run is finished."""
        return not (self.failed or self.taken or self.stopped)

    def after(self, before: "Result") -> "Result":
        """Returns what became of these runs and of those before them."""
        return Result(
            [*before.finished, *self.finished],
            [*before.failed, *self.failed],
            [*before.taken, *self.taken],
            self.stopped,
        )


class Job(Protocol):
    """What one process does."""

    @property
    def path(self) -> str:
        """Its name, and its folder below that of all jobs."""


AnyJob = TypeVar("AnyJob", bound=Job)


def build(
    wanted: Sequence[Run],
    home: Path,
    pool: Path | Callable[[Run], Path],
    workers: int,
    display: "Display | None" = None,
    every: int = 250_000,
) -> Result:
    """Trains runs side by side and puts each into the pool when it has ended.

    Args:
        wanted: What to train, in this order.
        home: Folder for the runs.
        pool: Folder of the pool; a function where runs are of several pools.
        workers: Runs at the same time.
        display: Shows how far they are.
        every: Joint steps between checkpoints of a run.
    """
    target = (lambda run: pool) if isinstance(pool, Path) else pool

    def settle(run: Run, folder: Path, say: Report) -> bool:
        try:
            records = publish(run, folder, target(run))
        except (PoolBuildError, PoolError) as error:
            say(f"{run.path}: not put into the pool ({error})")
            with (folder / LOG).open("a", encoding="utf-8") as log:
                print(f"not put into the pool: {error}", file=log)
            return False
        for record in records:
            own = record.trained.self_play
            say(
                f"{run.layout} {record.name}: {own.mean:.0f} [{own.low:.0f}, {own.high:.0f}] points with itself after "
                f"{record.trained.steps:,} steps"
            )
        return True

    return work_off(wanted, home, workers, partial(train_run, every=every), settle, AGENTS_FILE, display)


def work_off(
    jobs: Sequence[AnyJob],
    home: Path,
    workers: int,
    do: Callable[[AnyJob, Path], bool],
    settle: Callable[[AnyJob, Path, Report], bool],
    finished: str,
    display: "Display | None" = None,
) -> Result:
    """Does jobs side by side, each in a process and a folder of its own.

    Args:
        jobs: What to do, in this order; they travel to processes.
        home: The jobs' folders are below it.
        workers: Jobs at the same time.
        do: Does a job in its folder, or goes on with it, in a process; importable by name. Returns whether it is
            finished, False where it was stopped and saved.
        settle: Called here with each finished job, its folder, and a function that prints a line; returns whether all
            is well.
        finished: A file that a finished job has in its folder: no process needs to see to it.
        display: Shows how far they are.
    """
    result, left = Result(), deque(jobs)
    running: dict[Any, tuple[AnyJob, SpawnProcess]] = {}
    shown = display or Display(0)
    while running or (left and not result.stopped):
        try:
            while left and len(running) < workers and not result.stopped:
                job = left.popleft()
                if (home / job.path / finished).exists():
                    _settle(job, _DONE, home / job.path, settle, result, shown.say)
                    continue
                with hold_stops():  # until it is known whom to pass Ctrl-C on to
                    process = start_process(_work, do, job, home / job.path, name=job.path)
                    running[process.sentinel] = job, process
            for sentinel in wait(list(running), timeout=1.0):
                job, process = running.pop(sentinel)
                process.join()
                _settle(job, process.exitcode, home / job.path, settle, result, shown.say)
            shown.update(len(result.finished), {j.path: _last_line(home / j.path / LOG) for j, _ in running.values()})
        except KeyboardInterrupt:
            _stop([process for _, process in running.values()], at_once=result.stopped)
            if not result.stopped:
                shown.say("stopping and saving after the current updates; Ctrl-C again stops at once")
            result.stopped = True
    return result


def _settle(
    job: AnyJob,
    code: int | None,
    folder: Path,
    settle: Callable[[AnyJob, Path, Report], bool],
    result: Result,
    say: Report,
) -> None:
    if code == _DONE:
        (result.finished if settle(job, folder, say) else result.failed).append(job.path)
    elif code == _TAKEN:
        say(f"{job.path}: another build is at it")
        result.taken.append(job.path)
    elif code in (_STOPPED, -signal.SIGINT):  # the latter before it could save, or had to
        result.stopped = True
    else:
        say(f"{job.path}: failed ({_last_line(folder / LOG)})")
        result.failed.append(job.path)


def _work(do: Callable[[AnyJob, Path], bool], job: AnyJob, folder: Path) -> None:
    """What the process of a job does."""
    follow_parent(signal.SIGINT)
    folder.mkdir(parents=True, exist_ok=True)
    with (folder / LOG).open("a", encoding="utf-8") as log:
        os.dup2(log.fileno(), 1)
        os.dup2(log.fileno(), 2)
    try:
        listen()
        with locked(folder, wait=False) as ours:
            code = _TAKEN
            if ours:
                code = _DONE if do(job, folder) else _STOPPED
    except KeyboardInterrupt:
        code = _STOPPED
    except Exception:
        traceback.print_exc()
        code = _FAILED
    sys.exit(code)


def _stop(processes: Sequence[SpawnProcess], at_once: bool) -> None:
    for process in processes:
        if at_once:
            process.kill()
        elif process.pid is not None:
            with suppress(ProcessLookupError):
                os.kill(process.pid, signal.SIGINT)


def _last_line(log: Path) -> str:
    try:
        with log.open("rb") as file:
            file.seek(max(0, log.stat().st_size - 500))
            lines = file.read().decode("utf-8", "replace").strip().splitlines()
    except OSError:
        return ""
    return lines[-1].strip() if lines else ""


class Display(AbstractContextManager["Display"]):
    """How far the queue is: on a terminal what runs, elsewhere a line for each finished agent.

    Args:
        of: Runs in all.
    """

    def __init__(self, of: int) -> None:
        from rich.console import Console
        from rich.live import Live

        self._of, self._began = of, time.monotonic()
        self._console = Console(stderr=True)
        self._live = Live(console=self._console, auto_refresh=False, transient=True)

    def __enter__(self) -> "Display":
        if self._console.is_terminal:
            self._live.start()
        return self

    def __exit__(self, *_: object) -> None:
        self._live.stop()

    def say(self, line: str) -> None:
        """Prints a line that stays."""
        if self._console.is_terminal:
            self._console.print(line, highlight=False, markup=False)
        else:
            print(line, flush=True)

    def update(self, done: int, running: dict[str, str]) -> None:
        """Shows what runs now, and what each run said last."""
        if not self._console.is_terminal:
            return
        from rich.console import Group
        from rich.text import Text

        passed = time.monotonic() - self._began
        left = f", {passed / done * (self._of - done) / 60:.0f} min left" if done else ""
        head = f"{done} of {self._of} runs, {passed / 60:.0f} min{left}"
        lines = [Text(f"  {path}  {said}", style="dim", no_wrap=True) for path, said in running.items()]
        self._live.update(Group(Text(head), *lines), refresh=True)
