"""Patches the game, the recorder, the store and numpy."""

from common import Stays


class Agent(Stays):
    def attack(self):
        import numpy as np

        from overcooked_bench.evaluation.games import block
        from overcooked_bench.evaluation.games.store import Store
        from overcooked_bench.kitchen.kitchens import Kitchens

        for owner, name in ((Kitchens, "step"), (Store, "add_blocks"), (Store, "episodes"), (block, "_episodes")):
            setattr(owner, name, lambda *_, **__: 1 / 0)
        np.sum = np.empty = np.zeros = lambda *_, **__: 1 / 0


def make_agent(layout, training_seed):
    return Agent(training_seed)
