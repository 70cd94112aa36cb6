"""The template process: it has imported libraries, runs no code of a submission, and makes copies of itself that do.

A copy starts in milliseconds, where Python and the libraries take seconds, so that every agent gets a process in which
no other one has been. In a sandbox of bubblewrap the template is in it, too.
"""

import gc
import os
import shutil
import signal
import socket
import sys
import time
from contextlib import suppress
from importlib import import_module
from typing import Final

import msgspec

from overcooked_bench.agents.isolation.confine import confine, hide_memory
from overcooked_bench.agents.isolation.frames import receive
from overcooked_bench.agents.isolation.player import serve

READY: Final = b"ready"
COPY: Final = b"copy "
END: Final = b"end "
"""Order: end a copy. It begins the answer, too."""
HOW: Final = b"how "
"""Order: end a copy that has ended on its own or soon will; the answer is its status."""
KILLED: Final = b"killed"
"""Instead of a status: it had to be ended."""

_PATIENCE: Final = 2.0
"""Seconds that a process which has closed its connection has to end."""


class Plan(msgspec.Struct, frozen=True):
    """What a template is started with.

    Attributes:
        path: The submission.
        function: The function in it that makes agents.
        modules: Libraries to import.
        scratch: The folder for temporary files; emptied whenever no copy is left.
        kernels: Folders of compiled kernels, which are copied to the scratch folder.
        filtered: Whether system calls are filtered.
        limits: The further arguments of `confine`.
    """

    path: str
    function: str
    modules: tuple[str, ...]
    scratch: str
    kernels: tuple[str, ...]
    filtered: bool
    limits: dict[str, int]


def main() -> None:
    """Makes and ends copies as it is asked to, until its parent has ended."""
    control = socket.socket(fileno=int(sys.argv[1]))
    plan = msgspec.json.decode(sys.argv[2], type=Plan)
    hide_memory()
    _refill(plan)
    for name in plan.modules:
        with suppress(Exception):  # the submission's own import shows what is wrong
            import_module(name)
    gc.collect()
    gc.freeze()
    control.send(READY)
    copies: set[int] = set()
    while True:
        try:
            order, file = receive(control)
        except OSError:
            order = b""
        if not order:
            for copy in copies:
                _end(copy, 0.0)
            with suppress(OSError):
                _empty(plan.scratch)
                os.rmdir(plan.scratch)
            os._exit(0)
        if file is not None:
            copy = _copy(plan, control, file)
            copies.add(copy)
            control.send(COPY + str(copy).encode())
            continue
        copy = int(order[len(END) :])
        control.send(END + (_end(copy, _PATIENCE if order.startswith(HOW) else 0.0) if copy in copies else KILLED))
        copies.discard(copy)
        if not copies:
            _refill(plan)


def _copy(plan: Plan, control: socket.socket, file: int) -> int:
    """Starts a copy that plays, and returns its number."""
    copy = os.fork()
    if copy:
        os.close(file)
        return copy
    try:
        control.close()
        confine(**plan.limits, filtered=plan.filtered)
        serve(socket.socket(fileno=file), plan.path, plan.function)
    except BaseException:
        sys.excepthook(*sys.exc_info())
        os._exit(70)
    os._exit(0)


def _end(copy: int, patience: float) -> bytes:
    """Ends a copy that has not ended after so many seconds; returns its status as `os.waitpid` does, or KILLED."""
    until = time.monotonic() + patience
    while True:
        found, status = os.waitpid(copy, os.WNOHANG)
        if found:
            return str(status).encode()
        if time.monotonic() >= until:
            break
        time.sleep(0.01)
    os.kill(copy, signal.SIGKILL)
    os.waitpid(copy, 0)
    return KILLED


def _refill(plan: Plan) -> None:
    """Empties the scratch folder, and puts the compiled kernels there again."""
    _empty(plan.scratch)
    for folder in plan.kernels:
        with suppress(OSError, shutil.Error):
            shutil.copytree(folder, os.path.join(plan.scratch, "kernels", os.path.basename(folder)))


def _empty(folder: str) -> None:
    for entry in os.scandir(folder):
        if entry.is_dir(follow_symlinks=False):
            shutil.rmtree(entry.path, ignore_errors=True)
        else:
            with suppress(OSError):
                os.unlink(entry.path)


if __name__ == "__main__":
    main()
