"""What the hostile submissions share: an agent that stays, and attacks on the way."""

import os

import numpy as np


class Stays:
    """Stays, and attacks once per episode."""

    observation = "lossless"

    def __init__(self, training_seed):
        self.training_seed = training_seed

    def reset(self, layout, seats, seeds):
        self.layout, self.step = layout, 0

    def act(self, observations):
        self.rows = len(observations)
        if self.step == 2:
            self.attack()
        self.step += 1
        return np.full(len(observations), 4)

    def attack(self):
        """Does harm."""


def reached(what):
    """Says that an attack got somewhere; the test reads it."""
    print(f"reached {what}", flush=True)


def links():
    """Yields the descriptors of this process that are sockets."""
    for name in os.listdir("/proc/self/fd"):
        try:
            if os.readlink(f"/proc/self/fd/{name}").startswith("socket:"):
                yield int(name)
        except OSError:
            continue
