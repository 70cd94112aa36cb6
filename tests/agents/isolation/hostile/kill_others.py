"""Kills its parent, and everything else that it can."""

import contextlib
import os
import signal

from common import Stays, reached


class Agent(Stays):
    def attack(self):
        others = [int(name) for name in os.listdir("/proc") if name.isdigit() and int(name) != os.getpid()]
        for process in (os.getppid(), 1, *(others if len(others) < 8 else ()), -os.getppid()):
            with contextlib.suppress(OSError):
                os.kill(process, signal.SIGKILL)
                reached("another process by a signal")
        with contextlib.suppress(OSError):
            os.kill(0, signal.SIGUSR1)
            reached("its group by a signal")


def make_agent(layout, training_seed):
    return Agent(training_seed)
