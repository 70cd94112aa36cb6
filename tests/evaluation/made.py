"""Small protocols, submissions and stores for the tests of evaluation."""

from functools import partial
from pathlib import Path

import msgspec

from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.evaluation.games.block import Block
from overcooked_bench.evaluation.score import score as whole_score

SCRIPTED_POOL = Path(__file__).parent.parent / "data" / "pools" / "scripted"
"""A pool of `greedy` and, as a floor, `random`, on the five classic layouts."""

SETTINGS = {
    "name": "tiny",
    "version": 0,
    "layouts": ["cramped_room"],
    "cooking": "auto",
    "horizon": 40,
    "start": "random",
    "object_probability": 0.5,
    "pool": str(SCRIPTED_POOL),
    "seats": [0, 1],
    "episodes": 2,
    "mode": "sample",
    "thresholds": [1, 3],
    "salt": "pepper",
}


def protocol_text(**changes):
    """A protocol file with some keys of either part changed; None leaves a key out."""
    settings = {key: value for key, value in {**SETTINGS, **changes}.items() if value is not None}
    top = {key: settings.pop(key) for key in ("name", "version") if key in settings}
    report = {key: settings.pop(key) for key in ("thresholds",) if key in settings}
    lines = [f"{key}: {value}" for key, value in top.items()]
    for part, keys in (("play", settings), ("report", report)):
        lines += [f"{part}:", *(f"  {key}: {value}" for key, value in keys.items())]
    return "\n".join(lines).replace("'", "") + "\n"


score = partial(whole_score, scenarios=False)
"""Scores without the scenarios, which take seconds."""


def changed(protocol, **play):
    """A protocol with other keys of `play`."""
    return msgspec.structs.replace(protocol, play=msgspec.structs.replace(protocol.play, **play))


def reporting(protocol, **report):
    """A protocol with other keys of `report`."""
    return msgspec.structs.replace(protocol, report=msgspec.structs.replace(protocol.report, **report))


def block(
    protocol, agent="greedy", layout="cramped_room", pool=None, seed=0, training_seed=0, episodes=(0,), salt="pepper"
):
    pool = pool or SCRIPTED_POOL
    return Block(
        agent=str(agent),
        agent_sha256=find(agent).sha256,
        protocol=protocol,
        salt=salt,
        pool=str(pool),
        pool_sha256=Pool.load(pool).hash,
        seed=seed,
        layout=layout,
        training_seed=training_seed,
        episodes=episodes,
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
DRAW = "return sample_actions(np.full((n, 6), 1 / 6), self.seeds + self.training_seed, step)"


def write_agent(file, act=DRAW, reset="pass", make="pass", observation="lossless", training_seeds=1):
    """Writes a submission that acts at random, or as told."""
    file.write_text(
        AGENT.format(act=act, reset=reset, make=make, observation=observation, training_seeds=training_seeds)
    )
    return file
