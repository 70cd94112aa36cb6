"""Fills its folder for temporary files."""

import os
from itertools import count
from pathlib import Path

from common import Stays


class Agent(Stays):
    def attack(self):
        for number in count():
            Path(os.environ["TMPDIR"], str(number)).write_bytes(bytes(1 << 26))


def make_agent(layout, training_seed):
    return Agent(training_seed)
