"""A deep copy of an environment plays on by itself, as planners that look ahead need it."""

import copy

import gymnasium as gym
import numpy as np
import pytest

from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from tests.agents.made import make_policy

ID, ROWS, STEPS = "Overcooked/CrampedRoom-v0", 4, 45


def single(**how):
    return gym.make(ID, **how)


def vector(**how):
    return gym.make_vec(ID, num_envs=ROWS, **how)


@pytest.mark.parametrize("partner", ["stay", "greedy"])
@pytest.mark.parametrize("make", [single, vector])
def test_a_copy_plays_the_same_game_and_leaves_the_first_alone(make, partner):
    env = make(partner=partner, horizon=30, shaping=1.0)
    env.reset(seed=3)
    draw = np.random.default_rng(0)
    actions = draw.integers(0, 6, (STEPS, ROWS)) if make is vector else draw.integers(0, 6, STEPS).tolist()

    def played(env, actions):
        seen = []
        for action in actions:
            seen.append(env.step(action)[:4])
            if make is single and seen[-1][3]:
                env.reset()
        return seen

    played(env, actions[:20])
    twin = copy.deepcopy(env)
    first, second = played(twin, actions[20:]), played(env, actions[20:])
    for one, other in zip(first, second, strict=True):
        for mine, expected in zip(one, other, strict=True):
            np.testing.assert_array_equal(mine, expected)
    views = np.stack([step[0] for step in first])
    assert (views != views[:1]).any()


@pytest.mark.parametrize("partners", [None, ["greedy", "neural"]], ids=["self-play", "partners"])
def test_a_copy_of_what_stable_baselines3_learns_from(partners, tmp_path):
    if partners:
        partners = [NeuralAgent(make_policy(tmp_path)) if name == "neural" else name for name in partners]
    envs = OvercookedVecEnv("cramped_room", ROWS, self_play=not partners, partners=partners or (), horizon=30)
    envs.seed(0)
    envs.reset()
    envs.step(np.zeros(envs.num_envs, int))
    twin = copy.deepcopy(envs)
    for actions in np.random.default_rng(0).integers(0, 6, (40, envs.num_envs)):
        mine, expected = twin.step(actions), envs.step(actions)
        for one, other in zip(mine[:3], expected[:3], strict=True):
            np.testing.assert_array_equal(one, other)
