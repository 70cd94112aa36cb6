"""Reads the memory of other processes: by /proc, and by the system call for it."""

import ctypes
import os

from common import Stays, reached


class Agent(Stays):
    def attack(self):
        for name in filter(str.isdigit, os.listdir("/proc")):
            if int(name) == os.getpid():
                continue
            try:
                with open(f"/proc/{name}/mem", "rb") as memory, open(f"/proc/{name}/maps") as maps:
                    memory.seek(int(maps.readline().split("-")[0], 16))
                    if memory.read(1):
                        reached("memory of another process")
            except (OSError, ValueError):
                continue
        libc = ctypes.CDLL(None, use_errno=True)
        for call in ((16, os.getppid(), 0, 0), (101, 16, os.getppid(), 0, 0)):  # PTRACE_ATTACH
            found = libc.ptrace(*call) if call[0] == 16 else libc.syscall(*call)
            if found == 0:
                reached("another process by ptrace")


def make_agent(layout, training_seed):
    return Agent(training_seed)
