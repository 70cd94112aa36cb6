"""Keeps a submission from opening files of its folder that are not in its hash."""

import os
import sys
import threading
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final

from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.submissions.content import is_compiled, ours

_EVENTS: Final = frozenset({"open", "sqlite3.connect"})
_running = threading.local()
_installed: list[bool] = []


class Guard:
    """Watches the files that a submission's code opens.

    It sees files that Python opens, and not those that libraries open on their own, as safetensors does; files that are
    named in the code are in the hash anyway.

    Args:
        folder: The submission's folder, or that of its file.
        content: Its files, as `content.content` lists them.
        is_folder: Whether the submission is the whole folder.
    """

    def __init__(self, folder: Path, content: Mapping[str, Path], is_folder: bool) -> None:
        self._folder, self._is_folder = os.path.abspath(folder), is_folder
        self._stamps = {str(file): stamp(file) for file in content.values()}
        self._ours = ours(folder)
        self._faults: list[str] = []

    @contextmanager
    def watch(self) -> Iterator[None]:
        """Watches this thread.

        Raises:
            AgentError: A file was opened that is not in the hash, or has been changed since it was hashed. Raised when
                it is opened, and again here if the submission's code caught the error.
        """
        if not _installed:
            sys.addaudithook(_hook)
            _installed.append(True)
        before, _running.guard = getattr(_running, "guard", None), self
        try:
            yield
        finally:
            _running.guard = before
        if self._faults:
            raise AgentError(self._faults[0])

    def check(self, path: Any, flags: Any) -> None:
        """Checks a file that is being opened.

        Raises:
            AgentError: It may not be opened.
        """
        if not isinstance(path, str | bytes) or (isinstance(flags, int) and flags & os.O_ACCMODE == os.O_WRONLY):
            return
        full = os.path.abspath(os.fsdecode(path))
        if not full.startswith(self._folder + os.sep) or full.startswith(self._ours) or is_compiled(full):
            return
        name = os.path.relpath(full, self._folder)
        if full in self._stamps:
            if stamp(full) == self._stamps[full]:
                return
            fault = f"{name} was changed after it was hashed; run it again, with another --output where blocks are done"
        elif not os.path.isfile(full):
            return
        elif self._is_folder:
            fault = (
                f"opens {name}, which is not part of its hash: files of tools and of scores are left out; move it to "
                "another place in the folder"
            )
        else:
            fault = (
                f"opens {name}, which is not part of its hash: name the file, its ending or its folder in the code, or "
                f"make the submission a folder with agent.py, whose files all count"
            )
        self._faults.append(f"{self._folder}: {fault}")
        raise AgentError(self._faults[-1])


def _hook(event: str, args: tuple[Any, ...]) -> None:
    if event in _EVENTS:
        guard: Guard | None = getattr(_running, "guard", None)
        if guard is not None:
            _running.guard = None  # files that the check itself opens are not checked
            try:
                guard.check(args[0], args[2] if event == "open" else None)
            finally:
                _running.guard = guard


def stamp(file: str | Path) -> tuple[int, int] | None:
    """Returns when a file was changed last, and its size; None if it is not there."""
    try:
        found = os.stat(file)
    except OSError:
        return None
    return found.st_mtime_ns, found.st_size
