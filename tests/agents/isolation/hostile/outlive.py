"""Leaves something for its next process: a global variable, a file, an attribute of a library."""

import os
from pathlib import Path

import numpy as np
from common import Stays, reached

KEPT = []


class Agent(Stays):
    def attack(self):
        place = Path(os.environ["TMPDIR"], "kept")
        if KEPT or place.exists() or hasattr(np, "kept"):
            reached("what an earlier process left")
        KEPT.append(1)
        np.kept = 1
        place.write_text("kept")


def make_agent(layout, training_seed):
    return Agent(training_seed)
