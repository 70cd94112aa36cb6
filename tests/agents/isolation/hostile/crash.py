"""Ends its process by a fault of memory."""

import ctypes

from common import Stays


class Agent(Stays):
    def attack(self):
        ctypes.string_at(0)


def make_agent(layout, training_seed):
    return Agent(training_seed)
