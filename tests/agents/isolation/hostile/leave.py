"""Ends its process, with the exit code of success."""

import os

from common import Stays


class Agent(Stays):
    def attack(self):
        os._exit(0)


def make_agent(layout, training_seed):
    return Agent(training_seed)
