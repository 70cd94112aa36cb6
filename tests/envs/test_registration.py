import gymnasium as gym
import pettingzoo
import pytest

import overcooked_bench
from overcooked_bench.envs.registration import CUSTOM_ID, env_id, register_environments
from overcooked_bench.envs.single import OvercookedEnv
from overcooked_bench.envs.vector import OvercookedVectorEnv
from overcooked_bench.kitchen.layout import Layout, layout_names
from tests.envs.players import TOMATO_KITCHEN

CLASSIC = ("CrampedRoom", "AsymmetricAdvantages", "CoordinationRing", "ForcedCoordination", "CounterCircuit")


def test_every_shipped_layout_has_an_id():
    ours = {name for name in gym.registry if name.startswith("Overcooked/")}
    assert ours == {env_id(name) for name in layout_names()} | {CUSTOM_ID}
    assert {f"Overcooked/{name}-v0" for name in (*CLASSIC, "Bottleneck", "Custom")} <= ours


@pytest.mark.parametrize("layout", layout_names())
def test_an_id_plays_its_layout(layout):
    env = gym.make(env_id(layout))
    assert isinstance(env.unwrapped, OvercookedEnv)
    assert env.unwrapped.kitchens.layout == Layout.load(layout)
    envs = gym.make_vec(env_id(layout), num_envs=3)
    assert isinstance(envs, OvercookedVectorEnv)
    assert envs.kitchens.layout == Layout.load(layout)


def test_no_step_limit_but_our_horizon_is_registered():
    env = gym.make("overcooked_bench:Overcooked/CrampedRoom-v0")
    assert env.spec.max_episode_steps is None
    assert "TimeLimit" not in str(env)


def test_a_spec_survives_json():
    spec = gym.make("Overcooked/CrampedRoom-v0", partner="stay", horizon=7).spec
    again = gym.make(gym.envs.registration.EnvSpec.from_json(spec.to_json()))
    assert again.unwrapped.kitchens.horizon == 7


def test_registering_again_changes_nothing():
    before = dict(gym.registry)
    gym.register_envs(overcooked_bench)
    register_environments()
    assert dict(gym.registry) == before


def test_a_custom_kitchen_from_a_grid_and_from_a_file(tmp_path):
    env = gym.make("Overcooked/Custom-v0", layout=TOMATO_KITCHEN, observation="lossless26")
    assert env.observation_space.shape == (26, 4, 5)
    path = tmp_path / "quick.layout"
    path.write_text(TOMATO_KITCHEN.strip("\n") + "\n---\norders: [[tomato, tomato, onion]]\ncook_time: 200\n")
    envs = gym.make_vec("Overcooked/Custom-v0", num_envs=2, layout=path, observation="lossless26")
    assert envs.kitchens.layout.orders == ((1, 2),)
    assert envs.single_observation_space.high.max() == 200


@pytest.mark.parametrize("make", [gym.make, gym.make_vec])
def test_a_custom_kitchen_needs_a_layout(make):
    with pytest.raises(ValueError, match=r"write layout= with a grid's text, the path of a \.layout file"):
        make("Overcooked/Custom-v0")


def test_the_same_ids_are_in_the_registry_of_pettingzoo():
    ours = {name for name in pettingzoo.parallel_registry if name.startswith("Overcooked/")}
    assert ours == {name for name in gym.registry if name.startswith("Overcooked/")}
    env = pettingzoo.make("parallel", "Overcooked/CounterCircuit-v0", horizon=7, observation="features")
    assert env.kitchens.layout == Layout.load("counter_circuit")
    assert list(env.reset(seed=0)[0]) == ["chef_0", "chef_1"]
    own = pettingzoo.make("parallel", "Overcooked/Custom-v0", layout=TOMATO_KITCHEN, observation="lossless26")
    assert own.observation_space("chef_0").shape == (26, 4, 5)
    with pytest.raises(TypeError, match="layout"):
        pettingzoo.make("parallel", "Overcooked/Custom-v0")


def test_an_older_pettingzoo_without_a_registry_is_no_hindrance(monkeypatch):
    monkeypatch.delattr(pettingzoo, "parallel_registry")
    monkeypatch.delitem(gym.registry, "Overcooked/CrampedRoom-v0")
    register_environments()
    assert "Overcooked/CrampedRoom-v0" in gym.registry
