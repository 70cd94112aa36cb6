import subprocess
import sys
import warnings

import numpy as np
import pytest

from overcooked_bench import parallel_env
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS
from overcooked_bench.kitchen.state import Chef, KitchenState, Soup

with warnings.catch_warnings():  # on import, PettingZoo's tests warn of an example that they load themselves
    warnings.filterwarnings("ignore", message="The old environment creation API", category=DeprecationWarning)
    from pettingzoo.test import parallel_api_test, parallel_seed_test

FILLING = KitchenState((Chef((2, 1), "north", "onion"), Chef((3, 2), "south", Soup((3, 0), 20, 20))), {})


@pytest.mark.parametrize("observation", OBSERVATIONS)
@pytest.mark.parametrize("layout", layout_names())
def test_pettingzoo_finds_no_fault(layout, observation):
    parallel_api_test(parallel_env(layout, observation=observation, horizon=40), num_cycles=100)
    parallel_seed_test(lambda: parallel_env(layout, observation=observation), num_cycles=20)


def test_pettingzoo_finds_no_fault_in_a_whole_episode():
    parallel_api_test(parallel_env("cramped_room"), num_cycles=500)


def test_the_same_seed_gives_the_same_episodes():
    first, second = parallel_env("counter_circuit", horizon=5), parallel_env("counter_circuit", horizon=5)
    rng = np.random.default_rng(0)
    seen = first.reset(seed=4), second.reset(seed=4)
    assert str(seen[0]) == str(seen[1])
    for _ in range(3):
        while first.agents:
            actions = {agent: int(rng.integers(6)) for agent in first.agents}
            assert str(first.step(actions)) == str(second.step(actions))
        assert str(first.reset()) == str(second.reset())


def test_each_chef_sees_its_own_view_and_gets_its_own_partial_reward():
    env = parallel_env("cramped_room", shaping=0.5)
    env.reset(seed=0)
    env.kitchens.set_state(0, FILLING)
    seen, rewards, terminated, truncated, infos = env.step({"chef_0": 5, "chef_1": 5})
    assert np.array_equal(np.stack([seen["chef_0"], seen["chef_1"]]), env.kitchens.observe("lossless")[0])
    assert rewards == {"chef_0": 21.5, "chef_1": 20.0}
    assert infos == {
        "chef_0": {"soup_reward": 20.0, "partial_reward": 3.0, "seat": 0},
        "chef_1": {"soup_reward": 20.0, "partial_reward": 0.0, "seat": 1},
    }
    assert terminated == truncated == {"chef_0": False, "chef_1": False}


def test_both_are_truncated_at_the_horizon_and_gone_then():
    env = parallel_env("cramped_room", horizon=1)
    env.reset()
    _, _, terminated, truncated, _ = env.step({"chef_0": 4, "chef_1": 4})
    assert truncated == {"chef_0": True, "chef_1": True}
    assert terminated == {"chef_0": False, "chef_1": False}
    assert env.agents == []
    with pytest.raises(ValueError, match=r"call reset\(\) before step\(\)"):
        env.step({})


def test_wrong_actions_are_refused():
    env = parallel_env("cramped_room")
    env.reset()
    with pytest.raises(ValueError, match="give one for each of chef_0, chef_1"):
        env.step({"chef_0": 4})
    with pytest.raises(TypeError, match=r"action 1\.5 of chef_1; give one whole number"):
        env.step({"chef_0": 4, "chef_1": 1.5})
    with pytest.raises(ValueError, match="chef 1: action 6"):
        env.step({"chef_0": 4, "chef_1": 6})


def test_frames():
    assert parallel_env("cramped_room").render() is None
    assert parallel_env("cramped_room", render_mode="rgb_array").render().dtype == np.uint8
    assert isinstance(parallel_env("cramped_room", render_mode="ansi").render(), str)


def test_without_pettingzoo_the_error_names_the_extra():
    code = """if True:
        import sys
        sys.modules["pettingzoo"] = None
        from overcooked_bench import *
        try:
            parallel_env("cramped_room")
        except ModuleNotFoundError as error:
            print(error)
    """
    out = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert "pip install 'overcooked-bench[pettingzoo]'" in out
