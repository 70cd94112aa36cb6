import numpy as np
import torch

from overcooked_bench.agents.policies.neural import PolicyStack
from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines.best_response import Config
from overcooked_bench.baselines.learning.algorithms import make_dqn
from overcooked_bench.baselines.learning.freeze import freeze
from overcooked_bench.baselines.running.run import make_env
from tests.baselines.tiny import SEED, SETTINGS


def test_the_best_action_of_dqn_stays_the_best_where_all_values_are_large(tmp_path):
    config = Config(**SETTINGS, algorithm="dqn")
    env = make_env(config, partners=["stay"])
    model = make_dqn(config, env, SEED)
    with torch.no_grad():
        model.q_net.q_net[-1].bias.copy_(60.0 + 0.01 * torch.arange(6))  # points that are still to come
        model.q_net.q_net[-1].weight.mul_(0.01)
    seen = env.reset()
    with torch.no_grad():
        values = model.q_net(torch.from_numpy(seen)).numpy()
    files = freeze(tmp_path / "policy", model, config)
    chances = PolicyStack([load_policy(files.weights)]).assign(np.zeros(len(seen), np.int64)).probabilities(seen)
    expected = torch.softmax(100 * torch.from_numpy(values), 1).numpy()
    np.testing.assert_allclose(chances, expected, atol=0.05)
