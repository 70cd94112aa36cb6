"""Answers by itself, past the code that checks answers: with other actions, sizes, numbers and kinds."""

import gc
import os
import time

from common import Stays, links

from overcooked_bench.agents.isolation import frames
from overcooked_bench.agents.isolation.frames import Frame, Message

TRAINING_SEEDS = 6


class Agent(Stays):
    def attack(self):
        (frame,) = (thing for thing in gc.get_objects() if type(thing) is Frame)
        number = 5  # make, reset, and the third act
        answer = [
            Message(frames.DONE, number, self.rows),
            Message(frames.DONE, number, 2**63),
            Message(frames.DONE, number + 3, self.rows),
            Message(99, number, 4000, row=-7),
            Message(frames.GAME, number, 10, row=2**31 - 1),
            Message(frames.DONE, number, 0),
        ][self.training_seed]
        frame.write(b"\xff" * frame.capacity)
        for link in links():
            os.write(link, answer.pack())
        time.sleep(60)


def make_agent(layout, training_seed):
    return Agent(training_seed)
