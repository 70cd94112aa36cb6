import sys

import numpy as np
import pytest
import torch

from overcooked_bench.agents.policies.neural import PolicyStack
from overcooked_bench.agents.policies.policy import load_policy
from overcooked_bench.baselines.learning.freeze import freeze
from overcooked_bench.baselines.learning.recurrent import make_recurrent
from overcooked_bench.baselines.learning.settings import SettingsError
from overcooked_bench.baselines.recurrent_ppo import Config
from overcooked_bench.baselines.running.run import make_env
from overcooked_bench.cli import main as command
from tests.baselines.tiny import SEED, SETTINGS


@pytest.mark.parametrize("head", [(), (9, 7)], ids=str)
def test_the_frozen_actor_plays_an_episode_as_recurrent_ppo_does(tmp_path, head):
    config = Config(**SETTINGS, units=12, head=head)
    env = make_env(config, self_play=True)
    model = make_recurrent(config, env, SEED, config.units, config.head)
    torch.manual_seed(0)
    with torch.no_grad():
        for parameter in model.policy.lstm_actor.parameters():
            parameter.normal_(0, 0.7)
        model.policy.action_net.weight.normal_(0, 2)  # far from equally likely actions, as those of a fresh one are
    frozen = load_policy(freeze(tmp_path / "policy", model, config).weights)
    env.seed(3)
    seen, rows = env.reset(), 2 * config.num_kitchens
    assignment = PolicyStack([frozen]).assign(np.zeros(rows, np.int64))
    states, starts, met = None, np.ones(rows, bool), []
    for _ in range(config.horizon):
        ours = assignment.probabilities(seen)
        before = np.zeros((2, 1, rows, config.units)) if states is None else np.stack(states)
        given = tuple(torch.tensor(part * ~starts[:, None], dtype=torch.float32) for part in before)
        with torch.no_grad():
            theirs = model.policy.get_distribution(torch.from_numpy(seen), given, torch.zeros(rows))[0]
        np.testing.assert_allclose(ours, theirs.distribution.probs.numpy(), atol=1e-3)
        actions, states = model.predict(seen, state=states, episode_start=starts)
        seen, _, starts, _ = env.step(actions)
        met.append(ours)
    assert starts.all(), "a whole episode"
    assert np.max(met) > 0.8


def test_settings_of_the_memory_are_checked():
    with pytest.raises(SettingsError, match="units=0"):
        Config(**SETTINGS, units=0)
    with pytest.raises(SettingsError, match="head="):
        Config(**SETTINGS, head=(8, 0))


def test_without_sb3_contrib_it_says_what_to_install(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(sys.modules, "sb3_contrib", None)
    monkeypatch.delitem(sys.modules, "overcooked_bench.baselines.learning.recurrent", raising=False)
    arguments = ["train", "recurrent-ppo", "--layout", "cramped_room", "--output", str(tmp_path / "run")]
    assert command(arguments) == 2
    assert "pip install 'overcooked-bench[recurrent]'" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()
