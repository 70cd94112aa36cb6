"""Prints a million lines, with escape sequences."""

import sys

from common import Stays


class Agent(Stays):
    def attack(self):
        sys.stdout.buffer.write(b"\x1b[2Jboo\n" * 1_000_000)
        sys.stdout.flush()


def make_agent(layout, training_seed):
    return Agent(training_seed)
