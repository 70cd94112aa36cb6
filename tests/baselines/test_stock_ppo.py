import numpy as np
import pytest
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.policies import ActorCriticPolicy

from overcooked_bench import Kitchens
from overcooked_bench.agents.policies.neural import PolicyStack
from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines.learning.freeze import freeze
from overcooked_bench.baselines.learning.stock import make_stock_ppo
from overcooked_bench.baselines.running.run import make_env
from overcooked_bench.baselines.stock_ppo import Config
from tests.baselines.tiny import SETTINGS
from tests.kitchen.strategies import joint_actions

LAYOUT = "coordination_ring"


def learner(**others):
    config = Config(**SETTINGS | {"layout": LAYOUT, "hidden": (32, 16)} | others)
    return config, make_stock_ppo(config, make_env(config, self_play=True), 3)


@pytest.mark.parametrize("observation", ["lossless", "lossless_2019"])
@pytest.mark.parametrize("network", ["mlp", "cnn"])
def test_a_frozen_policy_plays_as_the_one_that_sb3_trained(network, observation, tmp_path):
    config, model = learner(network=network, observation=observation)
    model.learn(model.n_envs * model.n_steps)
    with torch.no_grad():
        model.policy.action_net.weight.normal_(0, 2)  # no two actions alike
    model.policy.half().float()  # what float16 can hold
    kitchens = Kitchens(LAYOUT, 4, object_probability=0.5)
    for joint in joint_actions(0, 30, 4):
        kitchens.step(joint)
    views = kitchens.observe(observation)
    seen = views.reshape(-1, *views.shape[2:])
    with torch.no_grad():
        expected = model.policy.get_distribution(torch.from_numpy(seen)).distribution.probs.numpy()
    frozen = load_policy(freeze(tmp_path / "policy", model, config).weights)
    assert frozen.architecture.observation == observation
    chances = PolicyStack([frozen]).assign(np.zeros(len(seen), np.int64)).probabilities(seen)
    np.testing.assert_allclose(chances, expected, atol=1e-5)
    assert np.ptp(expected, axis=0).max() > 0.1


@pytest.mark.parametrize("network", ["mlp", "cnn"])
def test_the_learner_is_sb3s_own(network):
    _, model = learner(network=network)
    assert type(model) is PPO
    assert type(model.policy) is ActorCriticPolicy
