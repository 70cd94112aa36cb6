"""Worker processes on this machine: one that dies or hangs costs its own task, and a new one takes its place."""

import multiprocessing
import os
import pickle
import signal
import sys
import time
import traceback
from collections.abc import Callable, Generator, Iterable
from contextlib import AbstractContextManager, suppress
from dataclasses import dataclass
from multiprocessing.connection import Connection, wait
from multiprocessing.util import Finalize
from typing import Any, Final, TypeVar

from overcooked_bench.agents.watch import NO_ANSWER, Board, watch_by
from overcooked_bench.processes import follow_parent, hold_stops, kill_group, start_process

Task = TypeVar("Task")
Result = TypeVar("Result")

_BETWEEN_LOOKS: Final = 0.5
"""Seconds between two looks at what the workers call."""
_NOTHING: Final = object()


class Crew(AbstractContextManager["Crew"]):
    """Worker processes that wait between one `map` and the next; all end with the context.

    Args:
        workers: Processes at most; they start when they are needed.
    """

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._idle: list[_Worker] = []
        self._busy: list[_Worker] = []

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Ends all workers."""
        while workers := [*self._idle, *self._busy]:
            workers[0].end()
            self._forget(workers[0])

    def map(
        self,
        function: Callable[[Task], Result],
        tasks: Iterable[Task],
        lost: Callable[[Task, str], Result],
        patience: float | None = None,
    ) -> Generator[Result, None, None]:
        """Applies a function to tasks and yields the results as they come.

        What the function prints goes to standard error. A task whose worker was killed from outside, as by a machine
        that lacks memory, is given to another one once.

        Args:
            function: Importable by name.
            tasks: Picklable; one is taken when a worker is free.
            lost: Makes the result of a task whose worker died or was overdue, from the task and what happened.
            patience: Seconds that a call noted by `agents.watch.calling` may take; None for no limit.

        Raises:
            Exception: What the function raised.
        """
        remaining, again, retried = iter(tasks), list[Any](), list[Any]()
        try:
            while True:
                while len(self._busy) < self._workers:
                    task = again.pop() if again else next(remaining, _NOTHING)
                    if task is _NOTHING:
                        break
                    with hold_stops():  # until it is known which process to end
                        worker = self._idle.pop() if self._idle else _Worker()
                        self._busy.append(worker)
                    worker.give(function, task)
                if not self._busy:
                    return
                wait([worker.answers for worker in self._busy], timeout=_BETWEEN_LOOKS)
                for worker in list(self._busy):
                    answer = worker.take(patience)
                    if answer is None:
                        continue
                    self._forget(worker)
                    if isinstance(answer, _Lost):
                        worker.end()
                        task = worker.task
                        if answer.killed and not any(task is other for other in retried):
                            again.append(task)
                            retried.append(task)
                        else:
                            yield lost(task, answer.why)
                        continue
                    self._idle.append(worker)
                    if isinstance(answer, _Raised):
                        raise answer.error
                    yield answer.result
        finally:
            for worker in list(self._busy):
                worker.end()
                self._forget(worker)

    def _forget(self, worker: "_Worker") -> None:
        for home in (self._idle, self._busy):
            if worker in home:
                home.remove(worker)


@dataclass(frozen=True)
class _Done:
    """What the function returned."""

    result: Any


@dataclass(frozen=True)
class _Raised:
    """What the function raised, with the worker's traceback as a note."""

    error: Exception


@dataclass(frozen=True)
class _Lost:
    """Why a task came to nothing, in words, and whether the worker was killed."""

    why: str
    killed: bool = False


class _Worker:
    """A process with one task at a time.

    Attributes:
        task: The last one given.
        answers: Where its results come from.
    """

    def __init__(self) -> None:
        context = multiprocessing.get_context("spawn")
        self.task: Any = None
        self._board = Board(context)
        self.answers, theirs = context.Pipe()
        self._process = start_process(_work, theirs, self._board, name="overcooked-bench worker")
        theirs.close()
        self._at_exit = Finalize(None, self.end, exitpriority=1)  # where nobody left the crew's context
        self._call, self._since = 0, 0.0

    def give(self, function: Callable[[Any], Any], task: Any) -> None:
        """Hands over a task; a worker that has died shows that in `take`."""
        self.task = task
        with suppress(OSError):
            self.answers.send((function, task))

    def take(self, patience: float | None) -> "_Done | _Raised | _Lost | None":
        """Returns what became of the task, None while the worker is at it."""
        alive = self._process.is_alive()  # first: one that answers and dies has answered
        if self.answers.poll():
            try:
                answer = self.answers.recv()
            except (EOFError, OSError):
                return self._death()
            except Exception as error:
                return _Lost(f"the worker process sent no result ({type(error).__name__})")
            return answer if isinstance(answer, _Done | _Raised) else _Lost("the worker process sent no result")
        if not alive:
            return self._death()
        why = self._overdue(patience)
        return _Lost(why) if why else None

    def _overdue(self, patience: float | None) -> str | None:
        """Says which call takes longer than it may, None if none does."""
        call, now = self._board.call, time.monotonic()
        if call != self._call:
            self._call, self._since = call, now
        limit = (patience or 0.0) * self._board.allowance
        if not call or patience is None or now - self._since <= limit:
            return None
        return f"{self._board.what}: {NO_ANSWER} {limit:g} s; --act-timeout gives a slow agent longer"

    def end(self) -> None:
        """Ends the process and all that it has started."""
        if self._process.pid is not None:
            kill_group(self._process.pid, signal.SIGKILL)
        self._process.kill()  # before it had a group of its own
        self._process.join()
        self.answers.close()
        self._at_exit.cancel()

    def _death(self) -> "_Lost":
        self._process.join(timeout=5)
        code = self._process.exitcode
        if code is None:
            how = "closed its pipe"
        elif code >= 0:
            how = f"ended with exit code {code}"
        else:
            how = f"was ended by {signal.Signals(-code).name}"
            how += ", perhaps for lack of memory: use fewer --workers" if code == -signal.SIGKILL else ""
        what = f"{self._board.what}: " if self._board.call else ""
        return _Lost(f"{what}the worker process {how}", killed=code == -signal.SIGKILL)


def _work(pipe: Connection, board: Board) -> None:
    """What a worker process does: one task after the other, until its parent ends it."""
    follow_parent(signal.SIGKILL)
    os.dup2(2, 1)
    sys.stdout = sys.stderr
    watch_by(board)
    while True:
        try:
            function, task = pipe.recv()
        except (EOFError, OSError):
            os._exit(0)
        answer: _Done | _Raised
        try:
            answer = _Done(function(task))
        except Exception as error:
            answer = _Raised(_portable(error))
        pipe.send(answer)


def _portable(error: Exception) -> Exception:
    """Returns an error that survives pickling, with its traceback as a note."""
    told = "".join(traceback.format_exception(error))
    try:
        pickle.loads(pickle.dumps(error))
    except Exception:
        error = RuntimeError(f"{type(error).__name__}: {error}")
    error.add_note(f"in a worker process:\n{told}")
    return error
