"""What a worker of a cluster does: it leaves each task to a process of its own, so that it outlives what an agent does.

That process stays for the next task, since loading what plays takes seconds. Each thread of a worker has one.
"""

import os
import threading
from collections.abc import Callable
from contextlib import suppress
from importlib.metadata import PackageNotFoundError, version
from typing import Any, Final, NamedTuple

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.games.workers import Crew

_PACKAGES: Final = ("overcooked-bench", "numpy", "numba", "torch")


class EngineError(WrongUse):
    """An engine cannot be used here; the message says what to do instead."""


class Session(NamedTuple):
    """What all tasks of an engine have in common.

    Attributes:
        name: Tasks of different names never share a process.
        folder: Working directory that the engine was opened in.
        versions: Those of the packages that results depend on.
        patience: Seconds that a call noted by `agents.watch.calling` may take; None for no limit.
    """

    name: str
    folder: str
    versions: tuple[str, ...]
    patience: float | None = None


class Lost(NamedTuple):
    """A task came to nothing.

    Attributes:
        why: What happened, in words.
    """

    why: str


def versions() -> tuple[str, ...]:
    """Returns the packages that results depend on, with their versions here."""
    found = []
    for package in _PACKAGES:
        with suppress(PackageNotFoundError):  # from a source tree
            found.append(f"{package} {version(package)}")
    return tuple(found)


_kept = threading.local()
"""`crew` and `session`: the process of this thread, and the name of the session that it belongs to."""


def play_apart(session: Session, function: Callable[[Any], Any], task: Any) -> Any:
    """Applies a function to a task in this thread's own process.

    Returns:
        What the function returned, or a `Lost`.

    Raises:
        EngineError: Other versions are installed here than where the engine was opened.
        Exception: What the function raised.
    """
    if getattr(_kept, "session", None) != session.name:
        here = versions()
        if here != session.versions:
            raise EngineError(
                f"a worker of the cluster has {', '.join(here) or 'nothing installed'}, and this machine has "
                f"{', '.join(session.versions)}; results depend on all of them, so install the same versions everywhere"
            )
        if crew := getattr(_kept, "crew", None):
            crew.close()
        _kept.crew, _kept.session = Crew(1), session.name
    (answer,) = _kept.crew.map(_play_in, [(session.folder, function, task)], _lost, session.patience)
    return answer


def _play_in(called: tuple[str, Callable[[Any], Any], Any]) -> Any:
    folder, function, task = called
    with suppress(OSError):  # it need not exist on every machine
        os.chdir(folder)
    return function(task)


def _lost(_: object, why: str) -> Lost:
    return Lost(why)
