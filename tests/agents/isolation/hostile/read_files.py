"""Reads what does not belong to it: the pools, files of the user and the system, what other processes are called."""

import contextlib
import os
from pathlib import Path

from common import Stays, reached

from overcooked_bench.agents.entries import shipped_entries
from overcooked_bench.agents.pools.pool import shipped_pools


class Agent(Stays):
    def attack(self):
        with contextlib.suppress(ModuleNotFoundError):
            if shipped_pools() or shipped_entries():
                reached("the pools")
        for place in (Path(__file__).parents[1] / "elsewhere.txt", Path("/etc/passwd"), Path("/etc/hostname")):
            with contextlib.suppress(OSError):
                if place.read_bytes():
                    reached("files")
        for process in filter(str.isdigit, os.listdir("/proc")):
            with contextlib.suppress(OSError):
                command = Path(f"/proc/{process}/cmdline").read_text()
                if command and "isolation.template" not in command:
                    reached("other processes in /proc")


def make_agent(layout, training_seed):
    return Agent(training_seed)
