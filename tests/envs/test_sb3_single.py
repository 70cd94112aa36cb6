import warnings

import gymnasium as gym
import numpy as np
import pytest
from stable_baselines3 import DQN, PPO
from stable_baselines3.common.env_checker import check_env
from stable_baselines3.common.preprocessing import is_image_space

from overcooked_bench.envs.registration import env_id
from overcooked_bench.kitchen.layout import layout_names

NAME = "Overcooked/CrampedRoom-v0"
GRIDS = ("lossless", "lossless26", "stack_channels", "stack_states")
SHAPE_WARNINGS = (  # any three axes count as an image here, whatever their bounds, and four as unusual
    "It seems that your observation space  is an image but the upper and lower bounds are not in",
    "Treating image space as channels-last, while second dimension was smallest of the three",
    "The minimal resolution for an image is 36x36",
    "Your observation  has an unconventional shape",
)
PPO_TINY = {"n_steps": 64, "batch_size": 32, "n_epochs": 1, "policy_kwargs": {"net_arch": [8]}, "device": "cpu"}
DQN_TINY = {"learning_starts": 32, "buffer_size": 200, "policy_kwargs": {"net_arch": [8]}, "device": "cpu"}


@pytest.mark.parametrize("layout", layout_names())
def test_stable_baselines_finds_no_fault_in_the_features(layout):
    check_env(gym.make(env_id(layout), observation="features"))


@pytest.mark.parametrize("observation", GRIDS)
def test_stable_baselines_faults_grids_for_their_shape_alone(observation):
    env = gym.make(NAME, observation=observation)
    with warnings.catch_warnings():
        for text in SHAPE_WARNINGS:
            warnings.filterwarnings("ignore", message=text)
        check_env(env)
    assert not is_image_space(env.observation_space)


@pytest.mark.parametrize("observation", ["features", *GRIDS])
def test_ppo_learns_from_every_observation(observation):
    env = gym.make(NAME, observation=observation, horizon=50, shaping=1.0)
    model = PPO("MlpPolicy", env, seed=0, **PPO_TINY)
    before = model.policy.state_dict()["action_net.weight"].clone()
    model.learn(128)
    assert model.num_timesteps == 128
    assert not before.equal(model.policy.state_dict()["action_net.weight"])
    action, _ = model.predict(env.reset(seed=0)[0])
    assert env.action_space.contains(np.int64(action))


@pytest.mark.parametrize("observation", ["features", "lossless"])
def test_dqn_learns(observation):
    model = DQN("MlpPolicy", gym.make(NAME, observation=observation, horizon=50, shaping=1.0), seed=0, **DQN_TINY)
    before = model.q_net.state_dict()["q_net.0.weight"].clone()
    model.learn(128)
    assert model.replay_buffer.size() == 128
    assert not before.equal(model.q_net.state_dict()["q_net.0.weight"])
