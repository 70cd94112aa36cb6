"""Writes outside of its folder for temporary files: beside itself, into the package, and into the user's folders."""

import os
from pathlib import Path

from common import Stays, reached

import overcooked_bench

PLACES = (
    Path(__file__).parent.parent,
    Path(overcooked_bench.__file__).parent,
    Path("/usr"),
    Path("/dev"),
    Path("/dev/shm"),
    Path("/var/tmp"),
    Path("/"),
)


class Agent(Stays):
    def attack(self):
        for place in PLACES:
            try:
                file = place / "hostile-was-here"
                file.write_text("boo")
                file.unlink()
                reached("a place to write")
            except OSError:
                continue
        own = Path(os.environ["TMPDIR"]) / "mine"
        own.write_text("allowed")


def make_agent(layout, training_seed):
    return Agent(training_seed)
