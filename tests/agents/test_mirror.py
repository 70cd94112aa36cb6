from zlib import crc32

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench import Kitchens, Layout, UnknownLayout
from overcooked_bench.agents.mirror import mirror_actions, mirror_state, mirrored
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS

GRIDS = [name for name, observation in OBSERVATIONS.items() if observation.can_mirror]
LAYOUTS = ("cramped_room", "asymmetric_advantages", "counter_circuit")


class Hasher:
    """Plays by a sum over its observation in which every place counts differently."""

    def __init__(self, observation):
        self.observation = observation
        self.told = []

    def reset(self, layout, seats, seeds):
        self.told.append(layout)
        self.seeds = seeds

    def act(self, observations):
        if self.observation == "state":
            return np.array([crc32(repr(state).encode()) % 6 for state in observations])
        flat = np.reshape(observations, (len(observations), -1)).astype(np.uint64)
        weights = np.arange(flat.shape[1], dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        return (((flat * weights).sum(axis=1) + self.seeds) >> np.uint64(40)).astype(np.int64) % 6


def twins(layout, rows=6, seed=3):
    """Kitchens and their mirror images in the same states."""
    plain = Kitchens(layout, rows, history=3, object_probability=0.5)
    image = Kitchens(f"{layout}-mirrored", rows, history=3)
    plain.reset(seed=seed)
    for i in range(rows):
        image.set_state(i, mirror_state(plain.state(i), plain.layout.width))
    return plain, image


def views(kitchens, agent, seat):
    if agent.observation == "state":
        return [kitchens.state(i) for i in range(kitchens.num_kitchens)]
    return kitchens.observe(agent.observation)[:, seat]


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("observation", [*GRIDS, "state"])
def test_a_mirrored_agent_plays_the_mirrored_game(layout, observation):
    plain, image = twins(layout)
    agents, images = [Hasher(observation) for _ in "ab"], [mirrored(Hasher(observation)) for _ in "ab"]
    seeds = np.arange(6, dtype=np.uint64) << np.uint64(40)
    for seat in range(2):
        agents[seat].reset(layout, np.full(6, seat), seeds)
        images[seat].reset(f"{layout}-mirrored", np.full(6, seat), seeds)
    moved = 0
    for _ in range(25):
        joint = np.stack([agents[k].act(views(plain, agents[k], k)) for k in range(2)], axis=1)
        answer = np.stack([images[k].act(views(image, images[k], k)) for k in range(2)], axis=1)
        np.testing.assert_array_equal(answer, mirror_actions(joint))
        moved += np.isin(joint, (2, 3)).sum()
        plain.step(joint)
        image.step(answer)
    assert moved > 0
    for i in range(6):
        assert image.state(i) == mirror_state(plain.state(i), plain.layout.width)


@pytest.mark.parametrize("observation", GRIDS)
def test_mirrored_grids_are_what_the_mirrored_kitchen_shows(observation):
    plain, image = twins("asymmetric_advantages")
    rng = np.random.default_rng(0)
    for _ in range(15):
        shown = plain.observe(observation)
        seen = OBSERVATIONS[observation].mirrored(shown)
        np.testing.assert_array_equal(seen, image.observe(observation))
        np.testing.assert_array_equal(OBSERVATIONS[observation].mirrored(seen), shown)
        joint = rng.integers(0, 6, (6, 2))
        plain.step(joint)
        image.step(mirror_actions(joint))


@pytest.mark.parametrize("name", ["cramped_room", "cramped_room-mirrored", Layout.load("counter_circuit").text])
def test_the_agent_is_told_the_other_layout(name):
    agent = Hasher("lossless")
    mirrored(agent).reset(name, np.zeros(1, np.int64), np.zeros(1, np.uint64))
    assert agent.told == [Layout.load(name).mirrored().name]
    assert agent.told != [name]


def test_features_cannot_be_mirrored():
    with pytest.raises(UnknownLayout, match="features"):
        mirrored(Hasher("features"))


@settings(max_examples=20, deadline=None)
@given(actions=st.lists(st.integers(-2, 8), max_size=6))
def test_only_east_and_west_are_exchanged(actions):
    assert mirror_actions(actions).tolist() == [{2: 3, 3: 2}.get(action, action) for action in actions]
