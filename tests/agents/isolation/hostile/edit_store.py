"""Finds the store of the score and gives itself points: by its name, and by descriptors of other processes."""

import os
import sqlite3
from pathlib import Path

from common import Stays, reached


class Agent(Stays):
    def attack(self):
        home = Path(__file__).parent.parent
        files = list(home.rglob("*.sqlite"))
        for name in filter(str.isdigit, os.listdir("/proc")):
            try:
                for descriptor in os.scandir(f"/proc/{name}/fd"):
                    if Path(os.readlink(descriptor.path)).is_relative_to(home):
                        files.append(Path(descriptor.path))
            except OSError:
                continue
        for file in files:
            try:
                with sqlite3.connect(file, timeout=1) as store:
                    store.execute("UPDATE episodes SET soup_reward = 999")
                reached("the store")
            except sqlite3.Error:
                continue


def make_agent(layout, training_seed):
    return Agent(training_seed)
