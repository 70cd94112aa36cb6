"""Starts and stops processes: they end with their parent, and SIGTERM acts like Ctrl-C.

A process that is started here computes on one thread, never runs the user's own script again, and ignores Ctrl-C and
SIGTERM, which only its parent handles and may pass on. It ends when its parent has died, for whatever reason.
"""

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from multiprocessing import resource_tracker
from multiprocessing.context import SpawnProcess
from types import ModuleType
from typing import Any, Final

_ONE_THREAD: Final = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")
_STOPS: Final = (signal.SIGINT, signal.SIGTERM)
_STARTING: Final = threading.Lock()
"""Held while a process starts, which changes what all threads share."""


def start_process(function: Callable[..., object], *arguments: Any, name: str) -> SpawnProcess:
    """Starts a process that calls a function.

    Args:
        function: A function that can be imported by name; it calls `follow_parent` first.
        arguments: Its arguments, picklable.
        name: The process's name in messages of `multiprocessing`.
    """
    with _STARTING, hold_stops(), _quietly():
        process = multiprocessing.get_context("spawn").Process(target=function, args=arguments, name=name)
        process.start()
    return process


def follow_parent(end: signal.Signals) -> None:
    """Puts this process into its own group, which gets a signal when the parent has died.

    Args:
        end: SIGINT to stop like Ctrl-C, SIGKILL to end immediately.
    """
    parent = multiprocessing.parent_process()
    assert parent is not None
    if hasattr(os, "setpgrp"):
        os.setpgrp()

    def wait() -> None:
        parent.join()
        kill_group(os.getpid(), end)

    threading.Thread(target=wait, daemon=True).start()


def kill_group(pid: int, how: signal.Signals) -> None:
    """Sends a signal to a process that called `follow_parent`, and to all processes that it has started."""
    with suppress(ProcessLookupError, PermissionError):
        if hasattr(os, "killpg"):
            os.killpg(pid, how)
        else:
            os.kill(pid, how)


def listen() -> None:
    """Handles Ctrl-C and SIGTERM in a process of `start_process` from now on, pending ones included."""
    signal.signal(signal.SIGINT, signal.default_int_handler)
    signal.signal(signal.SIGTERM, _press_ctrl_c)
    if hasattr(signal, "pthread_sigmask"):
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _STOPS)


@contextmanager
def sigterm_as_ctrl_c() -> Iterator[None]:
    """Makes SIGTERM act like Ctrl-C; has no effect outside the main thread."""
    try:
        before = signal.signal(signal.SIGTERM, _press_ctrl_c)
    except ValueError:
        yield
        return
    try:
        yield
    finally:
        signal.signal(signal.SIGTERM, before)


def _press_ctrl_c(*_: object) -> None:
    signal.raise_signal(signal.SIGINT)


@contextmanager
def hold_stops() -> Iterator[None]:
    """Holds Ctrl-C and SIGTERM back for a moment; a process that is started meanwhile ignores them until it listens."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    resource_tracker.ensure_running()  # otherwise it starts with the process, and lets signals through
    before = signal.pthread_sigmask(signal.SIG_BLOCK, _STOPS)
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _quietly() -> Iterator[None]:
    """Sets up the rest that a new process inherits: one thread, and no script to run.

    A daemonic process, such as a worker of Dask, may not start another one, which it would leave behind; ours follow.
    """
    environment, script = {name: os.environ.get(name) for name in _ONE_THREAD}, sys.modules["__main__"]
    settings: dict[str, Any] = vars(multiprocessing.current_process()).get("_config", {})
    daemonic = settings.pop("daemon", None)
    try:
        os.environ.update(dict.fromkeys(_ONE_THREAD, "1"))
        sys.modules["__main__"] = ModuleType("__main__")
        yield
    finally:
        if daemonic is not None:
            settings["daemon"] = daemonic
        sys.modules["__main__"] = script
        for name, value in environment.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
