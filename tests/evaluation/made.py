"""Small protocols, submissions and stores for the tests of evaluation."""

from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.evaluation.games.block import Block

SETTINGS = {
    "name": "tiny",
    "version": 0,
    "layouts": ["cramped_room"],
    "cooking": "auto",
    "horizon": 40,
    "start": "random",
    "object_probability": 0.5,
    "pool": "null",
    "partners": ["greedy"],
    "floors": ["random"],
    "seats": [0, 1],
    "episodes": 2,
    "mode": "sample",
    "thresholds": [1, 3],
    "salt": "pepper",
}


def protocol_text(**changes):
    """A protocol file with some keys changed; None leaves a key out."""
    settings = {**SETTINGS, **changes}
    return "".join(f"{key}: {value}\n" for key, value in settings.items() if value is not None).replace("'", "")


def block(protocol, agent="greedy", layout="cramped_room", pool=None, seed=0, training_seed=0, episode=0):
    agent_sha256, pool_sha256 = find(agent).sha256, pool and Pool.load(pool).hash
    return Block(
        str(agent), agent_sha256, protocol, pool and str(pool), pool_sha256, seed, layout, training_seed, episode
    )


AGENT = """
import numpy as np
from overcooked_bench import UnknownLayout
from overcooked_bench.agents import sample_actions

TRAINING_SEEDS = {training_seeds}


class Agent:
    observation = "{observation}"

    def __init__(self, layout, training_seed):
        self.layout, self.training_seed = layout, training_seed

    def reset(self, layout, seats, seeds):
        self.seats, self.seeds, self.step = seats, seeds, 0
        {reset}

    def act(self, observations):
        n, step = len(observations), self.step
        self.step += 1
        {act}


def make_agent(layout, training_seed):
    {make}
    return Agent(layout, training_seed)
"""
DRAW = "return sample_actions(np.full((n, 6), 1 / 6), self.seeds, step)"


def write_agent(file, act=DRAW, reset="pass", make="pass", observation="lossless", training_seeds=1):
    """Writes a submission that acts at random, or as told."""
    file.write_text(
        AGENT.format(act=act, reset=reset, make=make, observation=observation, training_seeds=training_seeds)
    )
    return file
