"""Starts threads without end."""

import threading
import time

from common import Stays


class Agent(Stays):
    def attack(self):
        while True:
            threading.Thread(target=time.sleep, args=(1000,), daemon=True).start()


def make_agent(layout, training_seed):
    return Agent(training_seed)
