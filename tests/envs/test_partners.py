"""Partners by name, by path and as objects; neural ones in one forward."""

from collections import Counter

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from overcooked_bench import Kitchens, Layout, load_agent
from overcooked_bench.agents.policies.architectures import Cnn, Mlp
from overcooked_bench.agents.policies.ensemble import JoinedAgents
from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.policies.policy import load_policy, save_policy
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.envs.partners import Partners
from tests.agents.made import random_weights, small_cnn, small_mlp
from tests.envs.players import Wanderer

NAME = "Overcooked/ForcedCoordination-v0"
SUBMISSION = """
import numpy as np

class North:
    observation = "features"
    def reset(self, layout, seats, seeds):
        self.rows = len(seats)
    def act(self, observations):
        return np.zeros(self.rows, int)

def make_agent(layout, training_seed):
    return North()
"""


def play(partner, num_envs=3):
    envs = gym.make_vec(NAME, num_envs, partner=partner, horizon=40)
    envs.reset(seed=8)
    for actions in np.random.default_rng(0).integers(0, 6, (39, num_envs)):
        envs.step(actions)
    return [envs.kitchens.state(i) for i in range(num_envs)]


@pytest.mark.parametrize("name", SCRIPTED)
def test_a_scripted_agent_by_name_is_that_agent(name):
    assert play(name) == play(load_agent(name, "forced_coordination"))


@pytest.mark.parametrize("name", ["random", "greedy"])
def test_gymnasium_finds_no_fault_with_a_scripted_partner(name):
    check_env(gym.make(NAME, partner=name).unwrapped, skip_render_check=True)


def test_a_submission_by_path(tmp_path):
    path = tmp_path / "north.py"
    path.write_text(SUBMISSION)
    for given in (path, str(path)):
        env = gym.make(NAME, partner=given, seat=1)
        env.reset(seed=0)
        for _ in range(5):
            env.step(4)
        assert env.unwrapped.kitchens.state(0).chefs[0].facing == "north"


def test_an_unknown_partner_is_answered_with_the_nearest_name():
    with pytest.raises(ValueError, match="greedy"):
        gym.make(NAME, partner="gredy")


class Apart(NeuralAgent):
    """A neural agent that is not joined with others."""


@pytest.fixture(scope="module")
def policies(tmp_path_factory):
    folder = tmp_path_factory.mktemp("policies")
    kinds = (small_mlp(), small_mlp(), small_cnn(), small_mlp(observation="lossless26", shape=(26, 4, 5)))
    found = []
    for i, kind in enumerate(kinds):
        weights = {name: 10 * w for name, w in random_weights(kind, i).items()}
        found.append(load_policy(save_policy(folder / f"policy-{i}", kind, weights).weights))
    return found


def neural(kind, policies, index):
    """Two that share an agent, greedy ones, and others, so that those who act together are neighbours or not."""
    return [
        kind(policies[0]),
        kind(policies[3]),
        kind(policies[:2], index=index),
        kind(policies[1], mode="greedy"),
        kind(policies[2]),
        kind(policies[0], mode="greedy"),
    ]


def acting(partners, steps=30):
    """The actions of partners in 16 kitchens, and how often each observation was made."""
    kitchens, made = Kitchens("cramped_room", 16), Counter()
    observe = kitchens.observe
    kitchens.observe = lambda name, *others, **more: made.update([name]) or observe(name, *others, **more)
    kitchens.reset(seed=0)
    rng = np.random.default_rng(0)
    party = Partners(partners, Layout.load("cramped_room"), 16)
    party.reset(kitchens, rng.integers(0, 2, 16), np.arange(16, dtype=np.uint64))
    actions = []
    for joint in rng.integers(0, 6, (steps, 16, 2)):
        actions.append(party.act(kitchens))
        kitchens.step(joint)
    return np.stack(actions), made


def test_neural_partners_act_as_each_would_alone(policies):
    together, _ = acting(neural(NeuralAgent, policies, [0, 1, 0]))
    apart, _ = acting(neural(Apart, policies, [0, 1, 0]))
    assert (together == apart).all()
    assert len(np.unique(together, axis=1).T) > 10


def test_neural_partners_act_in_one_forward_for_each_architecture_and_mode(policies, monkeypatch):
    forwards = Counter()
    for kind in (Mlp, Cnn):

        def counted(self, weights, inputs, kind=kind, forward=kind.forward):
            forwards[kind.__name__, self.observation, len(inputs)] += 1
            return forward(self, weights, inputs)

        monkeypatch.setattr(kind, "forward", counted)
    _, made = acting([*neural(NeuralAgent, policies, [1, 0]), "random", Wanderer("state")], steps=7)
    assert forwards == {
        ("Mlp", "lossless", 3): 7,  # those that sample
        ("Mlp", "lossless", 2): 7,  # the greedy ones
        ("Mlp", "lossless26", 1): 7,
        ("Cnn", "lossless", 1): 7,
    }
    assert set(made.values()) == {7}


def test_joined_agents_follow_an_index_that_changes(policies):
    agents = [NeuralAgent(policies[0]), NeuralAgent(policies[:2], index=[0, 1])]
    joined = JoinedAgents(agents, [3, 2])
    for index, expected in (([0, 1], [0, 0, 0, 1, 2]), ([1, 1], [0, 0, 0, 2, 2])):
        agents[1].assign(index)
        joined.reset("cramped_room", np.zeros(5, np.int64), np.arange(5, dtype=np.uint64))
        assert joined.members_of_rows.tolist() == expected


def test_only_agents_of_one_mode_are_joined(policies):
    with pytest.raises(ValueError, match="of one mode"):
        JoinedAgents([NeuralAgent(policies[0]), NeuralAgent(policies[1], "greedy")], [1, 1])


def test_neural_partners_of_another_layout_are_refused_when_the_game_begins(policies, tmp_path):
    kitchens = Kitchens("coordination_ring", 2)
    party = Partners([NeuralAgent(policies[0]), NeuralAgent(policies[1])], Layout.load("coordination_ring"), 2)
    with pytest.raises(ValueError, match="trained on 'cramped_room'"):
        party.reset(kitchens, np.zeros(2, np.int64), np.zeros(2, np.uint64))
