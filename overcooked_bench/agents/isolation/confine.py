"""Takes rights away from the process that a submission's code is about to run in."""

import ctypes
import os
import resource
import signal
from contextlib import suppress
from pathlib import Path
from typing import Final

from overcooked_bench.agents.isolation import seccomp

_SET_PARENT_DEATH_SIGNAL, _SET_DUMPABLE = 1, 4
_CAPABILITIES: Final = 0x20080522  # version 3 of the kernel's form


class _Header(ctypes.Structure):
    _fields_ = (("version", ctypes.c_uint), ("process", ctypes.c_int))


def hide_memory() -> None:
    """Keeps other processes of the user from reading this one's memory."""
    ctypes.CDLL(None).prctl(_SET_DUMPABLE, 0, 0, 0, 0)


def confine(
    memory: int, address_space: int, cpu_seconds: int, file_bytes: int, open_files: int, filtered: bool
) -> None:
    """Confines this process, without a way back.

    Args:
        memory: `Limits.memory`; the further ones likewise.
        address_space: See there.
        cpu_seconds: See there.
        file_bytes: See there.
        open_files: See there.
        filtered: Whether to filter its system calls.

    Raises:
        OSError: The kernel refuses.
    """
    libc = ctypes.CDLL(None, use_errno=True)
    libc.prctl(_SET_PARENT_DEATH_SIGNAL, signal.SIGKILL, 0, 0, 0)
    with suppress(OSError):  # the first to be ended where memory is short
        Path("/proc/self/oom_score_adj").write_text("1000")
    for what, most in (
        (resource.RLIMIT_DATA, memory),
        (resource.RLIMIT_AS, address_space),
        (resource.RLIMIT_FSIZE, file_bytes),
        (resource.RLIMIT_NOFILE, open_files),
        (resource.RLIMIT_CORE, 0),
    ):
        resource.setrlimit(what, (most, most))
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_seconds, cpu_seconds + 1))
    none = (ctypes.c_uint * 6)()
    if libc.capset(ctypes.byref(_Header(_CAPABILITIES, 0)), none) != 0:
        raise OSError(ctypes.get_errno(), "capabilities cannot be dropped")
    hide_memory()
    if filtered:
        seccomp.install(os.getpid())
