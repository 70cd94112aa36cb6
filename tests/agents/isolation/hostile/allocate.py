"""Allocates memory without end."""

from common import Stays


class Agent(Stays):
    def attack(self):
        kept = []
        while True:
            kept.append(bytearray(1 << 28))


def make_agent(layout, training_seed):
    return Agent(training_seed)
