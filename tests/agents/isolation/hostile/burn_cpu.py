"""Computes without end in a thread."""

import threading
import time

from common import Stays


class Agent(Stays):
    def attack(self):
        threading.Thread(target=_spin, daemon=True).start()
        time.sleep(10_000)


def _spin():
    while True:
        pass


def make_agent(layout, training_seed):
    return Agent(training_seed)
