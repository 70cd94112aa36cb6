"""Returns what is no action per row."""

import numpy as np
from common import Stays

ANSWERS = (
    lambda n: np.full(n - 1, 4),
    lambda n: np.full((n, 1), 4),
    lambda n: np.full(n, np.nan),
    lambda n: np.full(n, 6),
    lambda n: np.full(n, -1),
    lambda n: np.full(n, 260),
    lambda n: None,
    lambda n: [4, [4]],
    lambda n: np.full(n, True),
)
TRAINING_SEEDS = len(ANSWERS)


class Agent(Stays):
    def act(self, observations):
        return ANSWERS[self.training_seed](len(observations))


def make_agent(layout, training_seed):
    return Agent(training_seed)
