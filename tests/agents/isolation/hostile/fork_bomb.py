"""Makes processes without end, in every way there is."""

import ctypes
import multiprocessing
import os
import subprocess
import sys

from common import Stays, reached


class Agent(Stays):
    def attack(self):
        for way in (
            lambda: os._exit(0) if os.fork() == 0 else reached("another process"),
            lambda: reached("a program") if subprocess.run([sys.executable, "-c", ""]).returncode == 0 else None,
            lambda: multiprocessing.get_context("fork").Process(target=reached, args=("another process",)).start(),
            lambda: os.execv(sys.executable, [sys.executable, "-c", "print('reached a program')"]),
            lambda: os._exit(0) if ctypes.CDLL(None).vfork() == 0 else None,
        ):
            try:
                way()
            except OSError:
                continue


def make_agent(layout, training_seed):
    return Agent(training_seed)
