"""Looks for the kitchens, the partners and the table of payments in the frames and objects of its process."""

import gc
import sys

from common import Stays, reached


class Agent(Stays):
    def attack(self):
        frame = sys._getframe()
        while frame is not None:
            for name in ("kitchens", "parties", "partners", "block", "streams", "store", "salt"):
                if name in frame.f_locals:
                    reached(f"{name} in a frame")
            frame = frame.f_back
        names = {"Kitchens", "Seated", "Block", "Partner", "Store", "NeuralAgent", "Protocol"}
        for thing in gc.get_objects():
            if type(thing).__name__ in names and type(thing).__module__.startswith("overcooked_bench"):
                reached(f"an object {type(thing).__name__}")


def make_agent(layout, training_seed):
    return Agent(training_seed)
