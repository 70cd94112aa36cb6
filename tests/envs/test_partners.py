"""Partners by name, by path and as objects."""

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from overcooked_bench import load_agent
from overcooked_bench.agents.scripted import SCRIPTED

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
