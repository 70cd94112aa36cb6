"""What scripted agents do is frozen: a change of behaviour must be a new version, and a new trace here."""

import hashlib

import numpy as np
import pytest

from overcooked_bench import Kitchens
from overcooked_bench.agents.scripted import SCRIPTED

STEPS = 80
TRACES = {
    ("stay", 1): "1fd98e46c1205acb",
    ("random", 1): "85b1ce4835a82bfa",
    ("onion_courier", 1): "763f3fd2bf4a5bbd",
    ("dish_courier", 1): "46b06d695656c5b2",
    ("greedy", 1): "530450ac2cbf9864",
    ("hesitant", 1): "3d98a77123d7bc9b",
    ("counter_passer", 1): "437eb48c8f90ea17",
    ("clockwise", 1): "ec096d1f7381265d",
    ("anticlockwise", 1): "2da2373203f72367",
    ("waiter", 2): "68c4b60c574fa541",
    ("plates_first", 2): "2bbcbe0cbc1fce86",
}


def trace(name: str) -> str:
    """Hash of the joint actions of an agent with a copy of itself, on two layouts."""
    digest = hashlib.sha256()
    for layout in ("forced_coordination", "coordination_ring"):
        kitchens = Kitchens(layout, 3, object_probability=0.3)
        kitchens.reset(seed=5)
        pair = [SCRIPTED[name].factory(layout) for _ in range(2)]
        for seat, agent in enumerate(pair):
            agent.reset(layout, np.full(3, seat), np.arange(3, dtype=np.uint64))
        for _ in range(STEPS):
            views = kitchens.observe("lossless26")
            joint = np.stack([agent.act(views[:, seat]) for seat, agent in enumerate(pair)], axis=1)
            digest.update(joint.astype(np.uint8).tobytes())
            kitchens.step(joint)
    return digest.hexdigest()[:16]


@pytest.mark.parametrize("name", SCRIPTED)
def test_behaviour_is_that_of_its_version(name):
    known = TRACES[name, SCRIPTED[name].version]
    assert trace(name) == known, "raise the agent's version in agents/scripted.py and record the new trace"
