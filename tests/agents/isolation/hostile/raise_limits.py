"""Raises its limits, gets rights back, and makes name spaces of its own."""

import contextlib
import ctypes
import resource

from common import Stays, reached


class Agent(Stays):
    def attack(self):
        for what in (resource.RLIMIT_DATA, resource.RLIMIT_CPU, resource.RLIMIT_FSIZE):
            with contextlib.suppress(OSError, ValueError):
                resource.setrlimit(what, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
                reached("its limits")
        libc = ctypes.CDLL(None)
        if libc.unshare(0x10000000 | 0x00020000) == 0:
            reached("name spaces")
        if libc.mount(b"none", b"/scratch", b"tmpfs", 0, None) == 0:
            reached("mounts")
        if libc.setuid(0) == 0 and libc.chroot(b"/") == 0:
            reached("rights of root")


def make_agent(layout, training_seed):
    return Agent(training_seed)
