"""Adding an observation is one new file: all lists of observations are read from the registry."""

import gymnasium as gym
import numpy as np
import pytest
import torch

from overcooked_bench import Kitchens, Layout
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.agents.submissions.checks import check_agent
from overcooked_bench.baselines.learning.freeze import freeze
from overcooked_bench.baselines.learning.inputs import spreader
from overcooked_bench.evaluation.games.play import play_episodes
from overcooked_bench.kitchen import observations as folder
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS, find_observation, found, history_for
from tests.baselines.tiny import tiny, tiny_learner

FILE = '''
import numpy as np

from overcooked_bench.kitchen.batch import HELD
from overcooked_bench.kitchen.codes import NUM_ITEMS
from overcooked_bench.kitchen.observations.observation import Live, Observation


class Hands(Observation):
    """What each chef holds and held one step ago, own first, and a number that never changes."""

    name, history, can_mirror = "hands", 1, True

    def shape(self, layout):
        return (5,)

    def high(self, layout):
        return NUM_ITEMS

    def write(self, prepared, batch, past, viewers, out):
        for age, rows in enumerate((batch.rows, past[0][0])):
            for k in range(2):
                chef = (viewers + k) % 2
                out[:, :, 2 * age + k] = np.take_along_axis(rows, HELD + chef, 1)
        out[:, :, 4] = 7

    def mirrored(self, views):
        return views.copy()

    def live(self, layout):
        return Live(np.arange(4), np.array([0, 1, 2, 3, -1]))


OBSERVATION = Hands()
'''


@pytest.fixture
def hands(tmp_path, monkeypatch):
    """The file in the folder of observations, as far as the registry can tell."""
    (tmp_path / "hands.py").write_text(FILE)
    monkeypatch.setattr(folder, "__path__", [*folder.__path__, str(tmp_path)])
    for name, observation in found().items():
        monkeypatch.setitem(OBSERVATIONS, name, observation)


class Stays:
    observation = "hands"

    def __init__(self):
        self.seen = []

    def reset(self, layout, seats, seeds):
        pass

    def act(self, observations):
        self.seen.append(observations.copy())
        return np.full(len(observations), 4)


def test_the_shipped_ones():
    shown = {
        "lossless",
        "lossless26",
        "lossless_2019",
        "blind",
        "features",
        "jaxmarl",
        "stack_channels",
        "stack_states",
    }
    assert set(OBSERVATIONS) == shown
    assert all(name == observation.name for name, observation in OBSERVATIONS.items())
    assert history_for(["lossless", "stack_states", "state", ""]) == 3
    assert history_for(["lossless", "state"]) == 0
    with pytest.raises(ValueError, match="no observation named 'loseless'; did you mean 'lossless'"):
        find_observation("loseless")


def test_a_new_file_is_observed(hands):
    with pytest.raises(ValueError, match=r"'hands' needs the past: make Kitchens\(..., history=1\)"):
        Kitchens("cramped_room", 1).observe("hands")
    kitchens = Kitchens("cramped_room", 4, history=1, object_probability=0.9)
    kitchens.reset(seed=0)
    held = kitchens.batch.held
    np.testing.assert_array_equal(kitchens.observe("hands")[:, 1], np.c_[held[:, ::-1], held[:, ::-1], [7] * 4])
    np.testing.assert_array_equal(kitchens.observe("hands", seats=np.zeros(4, int)), np.c_[held, held, [7] * 4])
    before = held.copy()
    assert before.any()
    kitchens.set_state(0, kitchens.state(1))
    kitchens.step(np.full((4, 2), 4))
    assert kitchens.observe("hands")[1, 0].tolist() == [*before[1], *before[1], 7]


def test_environments_and_agents_see_it(hands):
    env = gym.make("overcooked_bench:Overcooked/CrampedRoom-v0", observation="hands")
    seen, _ = env.reset(seed=0)
    assert env.observation_space.contains(seen)
    assert env.observation_space.shape == (5,)
    agents = Stays(), Stays()
    check_agent(agents[0], "here")
    play_episodes("cramped_room", agents, episodes=2, horizon=3)
    assert [views.shape for views in agents[1].seen] == [(2, 5)] * 3
    play_episodes("cramped_room-mirrored", (mirrored(Stays()), Stays()), episodes=2, horizon=3)


def test_a_policy_of_it_is_trained_and_frozen(hands, tmp_path):
    layout = Layout.load("cramped_room")
    config = tiny(observation="hands")
    model = tiny_learner(config, 0)
    trunk = model.policy.features_extractor
    views = torch.tensor([[1, 2, 3, 0, 7]], dtype=torch.uint8)
    assert trunk.compact(views).tolist() == [[1, 2, 3, 0]]
    assert spreader(layout, "hands", (5,))(trunk.compact(views)).tolist() == views.tolist()
    model.learn(config.steps)
    policy = load_policy(freeze(tmp_path / "policy", model, config).weights)
    assert policy.architecture.observation == "hands"
