"""Plays one layout to the end, and ends its process on another one."""

import os

from common import Stays


class Agent(Stays):
    def attack(self):
        if self.layout != "cramped_room":
            os._exit(0)


def make_agent(layout, training_seed):
    return Agent(training_seed)
