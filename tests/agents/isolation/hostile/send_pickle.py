"""Sends a pickle, padded to the size of a message, that writes a file when it is loaded."""

import os
import pickle
from pathlib import Path

from common import Stays, links

from overcooked_bench.agents.isolation.frames import PACKET


class Writes:
    def __reduce__(self):
        return Path.write_text, (Path("/tmp/p"), "")


class Agent(Stays):
    def attack(self):
        data = pickle.dumps(Writes(), protocol=5)
        assert len(data) != PACKET
        for link in links():
            os.write(link, data)


def make_agent(layout, training_seed):
    return Agent(training_seed)
