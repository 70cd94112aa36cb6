"""Sends messages of wrong sizes."""

import os

from common import Stays, links


class Agent(Stays):
    def attack(self):
        for link in links():
            os.write(link, b"x" * (1 if self.training_seed else 10_000))


TRAINING_SEEDS = 2


def make_agent(layout, training_seed):
    return Agent(training_seed)
