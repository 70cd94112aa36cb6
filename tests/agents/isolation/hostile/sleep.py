"""Sleeps without end."""

import time

from common import Stays


class Agent(Stays):
    def attack(self):
        time.sleep(10_000)


def make_agent(layout, training_seed):
    return Agent(training_seed)
