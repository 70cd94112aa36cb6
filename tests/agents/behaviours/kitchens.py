"""Small kitchens in which a behaviour is watched."""

import numpy as np

from overcooked_bench import Kitchens
from overcooked_bench.agents.behaviours.behaviour import Behaviour
from overcooked_bench.kitchen.codes import STAY
from overcooked_bench.kitchen.state import Chef, KitchenState, Soup

READY, COOKING = Soup((3, 0), 20, 20), Soup((3, 0), 5, 20)


class Watched:
    """A kitchen with a behaviour on seat 1; `play` gives its actions."""

    def __init__(self, layout, me, partner, objects=None):
        self.kitchens = Kitchens(layout, 1, events=True)
        self.kitchens.autoreset = False
        self.kitchens.set_state(0, KitchenState((Chef(*partner), Chef(*me)), objects or {}))
        self.events = np.zeros((2, 25), np.int64)
        self.t = 0

    @property
    def state(self):
        return self.kitchens.state(0)

    @property
    def me(self):
        return self.state.chefs[1]

    def play(self, behaviour: Behaviour, steps: int, mates=()):
        played = []
        for k in range(steps):
            played.append(behaviour.act(self.kitchens.layout, self.state, 1, self.t))
            partner = mates[k] if k < len(mates) else STAY
            self.events += self.kitchens.step([[partner, played[-1]]]).events[0]
            self.t += 1
        return played
