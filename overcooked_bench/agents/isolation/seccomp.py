"""A filter of system calls: no other processes, no sockets, no look into processes, no signals to others.

The kernel checks it for every call of the process that installs it, and nothing can take it away. It stays in force
without bubblewrap, and when we run as root, whom limits on the number of processes do not hold.
"""

import ctypes
import platform
from collections.abc import Iterator
from dataclasses import dataclass
from errno import ENOSYS, EPERM
from typing import Final


@dataclass(frozen=True)
class Machine:
    """The numbers of system calls of a kind of processor.

    Attributes:
        audit: The kernel's name for it, AUDIT_ARCH_....
        clone: Makes threads, which are allowed, and processes, which are not.
        signals: Calls whose first argument is the process that gets a signal; only the own one is allowed.
        limits: Sets limits of the process that its first argument names; only 0, the own one, is allowed.
        denied: Calls that fail.
    """

    audit: int
    clone: int
    signals: tuple[int, ...]
    limits: int
    denied: tuple[int, ...]


_EVERYWHERE: Final = (
    *(424, 425, 430, 432, 434, 438),  # pidfd_send_signal, io_uring_setup, fsopen, fsmount, pidfd_open, pidfd_getfd
    *(428, 429, 442),  # open_tree, move_mount, mount_setattr
)
MACHINES: Final = {
    "x86_64": Machine(
        audit=0xC000003E,
        clone=56,
        signals=(62, 234, 129, 297),  # kill, tgkill, rt_sigqueueinfo, rt_tgsigqueueinfo
        limits=302,  # prlimit64
        denied=(
            *(57, 58, 59, 322),  # fork, vfork, execve, execveat
            *(101, 310, 311, 312, 200),  # ptrace, process_vm_readv, process_vm_writev, kcmp, tkill
            *(41, 42, 49, 50),  # socket, connect, bind, listen
            *(109, 112, 272, 308),  # setpgid, setsid, unshare, setns
            *(161, 165, 166, 155, 304),  # chroot, mount, umount2, pivot_root, open_by_handle_at
            *(248, 249, 250, 298, 321, 323),  # add_key, request_key, keyctl, perf_event_open, bpf, userfaultfd
            *(29, 64, 68, 240, 319),  # shmget, semget, msgget, mq_open, memfd_create
            *(175, 313, 246),  # init_module, finit_module, kexec_load
            *_EVERYWHERE,
        ),
    ),
    "aarch64": Machine(
        audit=0xC00000B7,
        clone=220,
        signals=(129, 131, 138, 240),
        limits=261,
        denied=(
            *(221, 281),  # execve, execveat; there is no fork
            *(117, 270, 271, 272, 130),
            *(198, 203, 200, 201),
            *(154, 157, 97, 268),
            *(51, 40, 39, 41, 265),
            *(217, 218, 219, 241, 280, 282),
            *(194, 190, 186, 180, 279),
            *(105, 273, 104),
            *_EVERYWHERE,
        ),
    ),
}
"""By `platform.machine()`."""

_CLONE3: Final = 435  # takes its flags from memory, which a filter cannot read; libc then makes threads by clone
_CLONE_THREAD: Final = 0x00010000
_FOREIGN: Final = 0x40000000  # numbers of the x32 calls begin here

_LOAD, _EQUAL, _AT_LEAST, _ANY_BIT, _RETURN = 0x20, 0x15, 0x35, 0x45, 0x06
_NUMBER, _ARCHITECTURE, _FIRST_ARGUMENT = 0, 4, 16
_ALLOW: Final = 0x7FFF0000
_ERROR: Final = 0x00050000

_SET_NO_NEW_PRIVILEGES, _SET_SECCOMP, _FILTER = 38, 22, 2


class _Instruction(ctypes.Structure):
    _fields_ = (("code", ctypes.c_ushort), ("yes", ctypes.c_ubyte), ("no", ctypes.c_ubyte), ("value", ctypes.c_uint))


class _Program(ctypes.Structure):
    _fields_ = (("length", ctypes.c_ushort), ("instructions", ctypes.POINTER(_Instruction)))


def install(process: int) -> None:
    """Filters the system calls of this process from now on.

    Args:
        process: Its number.

    Raises:
        OSError: The kernel refuses.
        KeyError: There is no filter for this processor.
    """
    steps = [_Instruction(*step) for step in _filter(MACHINES[platform.machine()], process)]
    program = _Program(len(steps), (_Instruction * len(steps))(*steps))
    libc = ctypes.CDLL(None, use_errno=True)
    for call in ((_SET_NO_NEW_PRIVILEGES, 1, 0, 0, 0), (_SET_SECCOMP, _FILTER, ctypes.byref(program), 0, 0)):
        if libc.prctl(*call) != 0:
            raise OSError(ctypes.get_errno(), "the kernel refuses a filter of system calls")


def _filter(machine: Machine, process: int) -> Iterator[tuple[int, int, int, int]]:
    """Yields the instructions: (code, steps to skip if true, steps to skip if not, value)."""
    denied, unknown = _ERROR | EPERM, _ERROR | ENOSYS
    yield _LOAD, 0, 0, _ARCHITECTURE
    yield _EQUAL, 1, 0, machine.audit
    yield _RETURN, 0, 0, unknown
    yield _LOAD, 0, 0, _NUMBER
    yield _AT_LEAST, 0, 1, _FOREIGN
    yield _RETURN, 0, 0, unknown
    yield _EQUAL, 0, 1, _CLONE3
    yield _RETURN, 0, 0, unknown
    for number in machine.denied:
        yield _EQUAL, 0, 1, number
        yield _RETURN, 0, 0, denied
    conditions = [(machine.clone, _ANY_BIT, _CLONE_THREAD), (machine.limits, _EQUAL, 0)]
    for number, test, value in (*conditions, *((number, _EQUAL, process) for number in machine.signals)):
        yield _EQUAL, 0, 4, number
        yield _LOAD, 0, 0, _FIRST_ARGUMENT
        yield test, 0, 1, value
        yield _RETURN, 0, 0, _ALLOW
        yield _RETURN, 0, 0, denied
    yield _RETURN, 0, 0, _ALLOW
