"""Agents whose verdicts are known."""

import numpy as np

from overcooked_bench import UnknownLayout
from overcooked_bench.agents import uniforms

STAY, INTERACT = 4, 5


class Player:
    """Interacts in its first step with some probability, by its row's seed, then stays."""

    observation = "lossless26"

    def __init__(self, chance=1.0):
        self.chance = chance
        self.asked = []

    def reset(self, layout, seats, seeds):
        self.layout, self.seats, self.seeds, self.step = layout, seats, seeds, 0
        self.asked.append(len(seeds))

    def act(self, observations):
        self.seen = observations
        willing = (uniforms(self.seeds, 0) < self.chance) & (self.step == 0)
        self.step += 1
        return np.where(willing, INTERACT, STAY)


def player(chance=1.0):
    """A factory of players."""
    return lambda layout, training_seed: Player(chance)


def knows(*layouts, make=Player):
    """A factory of players that know some layouts alone."""

    def factory(layout, training_seed):
        if layout not in layouts:
            raise UnknownLayout(f"never seen {layout}")
        return make()

    return factory
