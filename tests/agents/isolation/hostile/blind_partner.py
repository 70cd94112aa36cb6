"""Changes the states that it is shown, to mislead its partner."""

import contextlib

import numpy as np
from common import Stays


class Agent(Stays):
    observation = "state"

    def act(self, observations):
        for state in observations:
            with contextlib.suppress(TypeError):
                state.objects.clear()
            dict.clear(state.objects)
            object.__setattr__(state, "timestep", 10_000)
        return np.full(len(observations), 4)


def make_agent(layout, training_seed):
    return Agent(training_seed)
