"""The sandbox of one submission, from our side: starts its template process, and copies and ends its processes."""

import os
import platform
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import weakref
from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.agents.isolation.bubblewrap import SCRATCH, command
from overcooked_bench.agents.isolation.frames import PACKET
from overcooked_bench.agents.isolation.output import Output
from overcooked_bench.agents.isolation.seccomp import MACHINES
from overcooked_bench.agents.isolation.settings import Isolation, IsolationError
from overcooked_bench.agents.isolation.template import COPY, END, HOW, KILLED, READY, Plan
from overcooked_bench.agents.submissions.checks import ForeignFault
from overcooked_bench.processes import kill_group

_STARTING: Final = 300.0
"""Seconds that the template may take to import libraries, on a busy machine too."""
_ENDING: Final = 30.0
"""Seconds in which the template answers."""
_ONE_THREAD: Final = ("OMP_NUM_THREADS", "MKL_NUM_THREADS", "OPENBLAS_NUM_THREADS", "NUMBA_NUM_THREADS")
_PASSED: Final = ("ATEN_CPU_CAPABILITY", "MKL_ENABLE_INSTRUCTIONS", "MKL_CBWR", "NUMBA_CPU_NAME", "NUMBA_DISABLE_JIT")
"""Variables that decide how numbers are computed; a submission's process has them as ours does."""


class Sandbox:
    """Where the processes of a submission run.

    Args:
        path: The submission.
        function: The function in it that makes agents.
        files: The files that it consists of.
        modules: Libraries that its template imports.
        kernels: Folders of compiled kernels that it gets copies of.
        isolation: How it is isolated.

    Attributes:
        isolation: How it is isolated.
        output: What its processes print.

    Raises:
        IsolationError: The template does not start.
    """

    def __init__(
        self,
        path: Path,
        function: str,
        files: Sequence[Path],
        modules: Sequence[str],
        kernels: Sequence[Path],
        isolation: Isolation,
    ) -> None:
        self.isolation = isolation
        sandboxed = isolation.level == "strong"
        scratch = SCRATCH if sandboxed else tempfile.mkdtemp(prefix="overcooked-bench-")
        plan = Plan(
            path=str(path),
            function=function,
            modules=tuple(modules),
            scratch=scratch,
            kernels=tuple(map(str, kernels)),
            filtered=platform.machine() in MACHINES,
            limits=asdict(isolation.limits),
        )
        around = command([*files, *kernels], isolation.limits.file_bytes) if sandboxed else None
        self._process, self._control, self.output = _start(plan, around)
        self._close = weakref.finalize(
            self, _close, self._process, self._control, self.output, None if sandboxed else scratch
        )
        if self._answer(_STARTING) != READY:
            self.output.drain()
            self.close()
            raise IsolationError("the process that submissions are to play in did not start; what it said is above")

    def copy(self) -> tuple[int, socket.socket]:
        """Starts a process that plays; returns its number, and where it is asked.

        Raises:
            ForeignFault: The template has died, which only the submission can have caused.
        """
        ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        with theirs, suppress(OSError):
            socket.send_fds(self._control, [COPY], [theirs.fileno()])
        answer = self._answer(_ENDING)
        if answer.startswith(COPY):
            return int(answer.removeprefix(COPY)), ours
        ours.close()
        self.close()
        raise ForeignFault("the process that the agents' processes are copied from has died")

    def end(self, process: int) -> None:
        """Ends a process."""
        self._order(END, process)

    def how_ended(self, process: int) -> str:
        """Says how a process that no longer answers has ended, after ending it where needed."""
        answer = self._order(HOW, process)
        if not answer or answer == KILLED:
            return "it closed the connection to its process" if answer else "its sandbox has ended"
        status = int(answer)
        code = os.waitstatus_to_exitcode(status)
        if code >= 0:
            return f"its process ended with exit code {code}"
        name = signal.Signals(-code).name
        why = {
            "SIGKILL": ", perhaps for lack of memory",
            "SIGXCPU": f": it had used its {self.isolation.limits.cpu_seconds} s of CPU time",
        }
        return f"its process was ended by {name}{why.get(name, '')}"

    @property
    def is_open(self) -> bool:
        """Whether it can start processes."""
        return self._close.alive

    def close(self) -> None:
        """Ends all its processes."""
        self._close()

    def _order(self, order: bytes, process: int) -> bytes:
        """Has a process ended; returns what the template says then, nothing if it does not answer."""
        if not self.is_open:
            return b""
        with suppress(OSError):
            self._control.send(order + str(process).encode())
        answer = self._answer(_ENDING)
        if not answer.startswith(END):
            self.close()
            return b""
        return answer.removeprefix(END)

    def _answer(self, seconds: float) -> bytes:
        """Waits for the template's answer; empty if there is none."""
        if self.output.wait(self._control, seconds):
            with suppress(OSError):
                return self._control.recv(PACKET)
        return b""


def _start(plan: Plan, around: Sequence[str] | None) -> tuple["subprocess.Popen[bytes]", socket.socket, Output]:
    """Starts a template, with the arguments of bwrap around it or without bwrap."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    read, write = os.pipe()
    words = [sys.executable, "-I", "-u", "-m", "overcooked_bench.agents.isolation.template"]
    words += [str(theirs.fileno()), msgspec.json.encode(plan).decode()]
    passed, listed = [theirs.fileno()], -1
    try:
        if around is not None:
            listed = os.memfd_create("arguments", os.MFD_CLOEXEC)
            with open(listed, "wb", closefd=False) as file:
                file.write("".join(f"{word}\0" for word in around).encode())
            os.lseek(listed, 0, os.SEEK_SET)
            passed.append(listed)
            words = [shutil.which("bwrap") or "bwrap", "--args", str(listed), *words]
        process = subprocess.Popen(
            words,
            stdin=subprocess.DEVNULL,
            stdout=write,
            stderr=write,
            env=_environment(plan.scratch),
            cwd=plan.scratch if around is None else "/",
            pass_fds=passed,
            start_new_session=True,
        )
    except OSError as error:
        raise IsolationError(f"the process that submissions are to play in cannot be started ({error})") from error
    finally:
        theirs.close()
        os.close(write)
        if listed >= 0:
            os.close(listed)
    return process, ours, Output(read)


def _environment(scratch: str) -> Mapping[str, str]:
    """Returns the environment of the template: nothing of ours but what decides how numbers are computed."""
    own = {"PATH": "/usr/bin:/bin", "LANG": "C.UTF-8", "USER": "submission", "LOGNAME": "submission"}
    own |= {"HOME": scratch, "TMPDIR": scratch, "NUMBA_CACHE_DIR": os.path.join(scratch, "kernels")}
    given = {name: os.environ[name] for name in _PASSED if name in os.environ}
    return {**own, **dict.fromkeys(_ONE_THREAD, "1"), **given}


def _close(process: "subprocess.Popen[bytes]", control: socket.socket, output: Output, scratch: str | None) -> None:
    """Ends a template and all that it has started."""
    kill_group(process.pid, signal.SIGKILL)
    process.kill()
    process.wait()
    control.close()
    output.close()
    if scratch is not None:
        shutil.rmtree(scratch, ignore_errors=True)
