import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench import Chef, Kitchens, KitchenState
from overcooked_bench.envs.event_rewards import event_weights
from overcooked_bench.envs.sb3 import OvercookedVecEnv
from overcooked_bench.kitchen.events import EVENTS
from tests.envs.players import Answers
from tests.kitchen.strategies import joint_actions

STAY, INTERACT = 4, 5
FILLING = KitchenState((Chef((1, 2), "west"), Chef((2, 1), "north", "onion")))
"""On cramped_room chef 1 fills the pot, if it interacts."""


def test_every_event_has_its_place():
    assert event_weights({}).tolist() == [0] * 25
    for i, name in enumerate(EVENTS):
        assert event_weights({name: -2}).tolist() == [-2.0 * (k == i) for k in range(25)]


@pytest.mark.parametrize(
    ("given", "told"),
    [
        ({"oinon_pickup": 1}, "names 'oinon_pickup'; did you mean 'onion_pickup'"),
        ({"": 1}, "Events are tomato_pickup, "),
        ({"soup_drop": float("nan")}, r"event_rewards\['soup_drop'\]=nan; give a finite number"),
        ({"soup_drop": float("inf")}, "finite"),
    ],
    ids=str,
)
def test_wrong_weights_are_refused(given, told):
    with pytest.raises(ValueError, match=told):
        OvercookedVecEnv("cramped_room", 2, event_rewards=given)


def test_an_event_rewards_the_chef_who_causes_it_whatever_the_shaping():
    for shaping, partial in ((0.0, 0), (1.0, 3)):
        env = OvercookedVecEnv(
            "cramped_room", 2, self_play=True, shaping=shaping, event_rewards={"potting_onion": 7, "dish_drop": 100}
        )
        env.reset()
        env.kitchens.set_state(1, FILLING)
        assert env.step(np.array([STAY, STAY, STAY, INTERACT]))[1].tolist() == [0, 0, 0, 7 + partial]


def test_a_share_of_the_event_rewards_is_paid():
    env = OvercookedVecEnv("cramped_room", 2, self_play=True, event_rewards={"potting_onion": 7})
    env.set_event_share(0.5)
    env.reset()
    env.kitchens.set_state(1, FILLING)
    assert env.step(np.array([STAY, STAY, STAY, INTERACT]))[1].tolist() == [0, 0, 0, 3.5]


@pytest.mark.parametrize(("seat", "reward"), [(0, 0), (1, -0.5)])
def test_against_partners_only_the_learners_events_count(seat, reward):
    env = OvercookedVecEnv(
        "cramped_room", 1, partners=[Answers(np.array([INTERACT]))], seat=seat, event_rewards={"potting_onion": -0.5}
    )
    env.reset()
    env.kitchens.set_state(0, FILLING)
    assert env.step(np.array([INTERACT]))[1].tolist() == [reward]


@settings(max_examples=10, deadline=None)
@given(st.dictionaries(st.sampled_from(EVENTS), st.floats(-10, 10), max_size=6), st.integers(0, 1000))
def test_rewards_are_the_soups_and_the_weighted_events(weights, seed):
    env = OvercookedVecEnv(
        "counter_circuit", 3, self_play=True, horizon=60, object_probability=0.9, event_rewards=weights
    )
    env.seed(seed)
    env.reset()
    twin = Kitchens("counter_circuit", 3, horizon=60, events=True)
    twin.restore(env.kitchens.snapshot())
    totals, soups = np.zeros(6), np.zeros(3)
    for joint in joint_actions(seed, 60, 3):
        _, rewards, dones, infos = env.step(joint.reshape(-1))
        result = twin.step(joint)
        expected = np.repeat(result.soup_reward.sum(1), 2)
        for row in range(6):
            happened = result.events[row // 2, row % 2]
            expected[row] += sum(weight for name, weight in weights.items() if happened[EVENTS.index(name)])
        np.testing.assert_allclose(rewards, expected, rtol=1e-5, atol=1e-5)
        totals, soups = totals + expected, soups + result.soup_reward.sum(1)
    assert dones.all()
    np.testing.assert_allclose([info["episode"]["r"] for info in infos], totals, rtol=1e-5, atol=1e-4)
    assert [info["episode_soup_reward"] for info in infos] == np.repeat(soups, 2).tolist()
