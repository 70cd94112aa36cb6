"""Kitchens of one batch do not know of each other, and a new episode is a new episode."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench import Kitchens
from tests.kitchen.strategies import COOKING, SEEDS, joint_actions, law, layouts, states

OPTIONS = {"start": "random", "object_probability": 0.5, "horizon": 11, "events": True, "actions_taken": True}


def all_states(kitchens: Kitchens) -> list:
    return [kitchens.state(i) for i in range(kitchens.num_kitchens)]


@law
@given(st.data(), COOKING, SEEDS)
def test_kitchen_i_of_a_batch_is_kitchen_i_alone(data, cooking, seed):
    layout = data.draw(layouts(cooking))
    keys = np.random.default_rng(seed).integers(0, 2**64, size=4, dtype=np.uint64)
    batch = Kitchens(layout, 4, cooking=cooking, **OPTIONS)
    alone = [Kitchens(layout, 1, cooking=cooking, **OPTIONS) for _ in keys]
    batch.reset(seed=keys)
    for i, kitchens in enumerate(alone):
        kitchens.reset(seed=keys[i : i + 1])
        if data.draw(st.booleans()):
            state = data.draw(states(layout, horizon=OPTIONS["horizon"]))
            batch.set_state(i, state)
            kitchens.set_state(0, state)
    for joint in joint_actions(seed, 30, kitchens=4):
        result = batch.step(joint)
        seen, features = batch.observe("lossless26"), batch.observe("features")
        for i, kitchens in enumerate(alone):
            single = kitchens.step(joint[i : i + 1])
            for together, by_itself in zip(result, single, strict=True):
                np.testing.assert_array_equal(together[i : i + 1], by_itself)
            assert batch.state(i) == kitchens.state(0)
            np.testing.assert_array_equal(seen[i], kitchens.observe("lossless26")[0])
            np.testing.assert_array_equal(features[i], kitchens.observe("features")[0])


@law
@given(st.data(), SEEDS)
def test_autoreset_is_a_reset(data, seed):
    layout = data.draw(layouts("auto"))
    itself, by_hand = (Kitchens(layout, 3, **OPTIONS) for _ in range(2))
    by_hand.autoreset = False
    for kitchens in (itself, by_hand):
        kitchens.reset(seed=seed)
    itself.set_state(1, shifted := data.draw(states(layout, horizon=OPTIONS["horizon"])))
    by_hand.set_state(1, shifted)
    for joint in joint_actions(seed, 30, kitchens=3):
        results = itself.step(joint), by_hand.step(joint)
        for ours, theirs in zip(*results, strict=True):
            np.testing.assert_array_equal(ours, theirs)
        over = results[1].truncated
        assert over.tolist() == [state.timestep == OPTIONS["horizon"] for state in all_states(by_hand)]
        by_hand.reset(mask=over)
        assert all_states(itself) == all_states(by_hand)
        np.testing.assert_array_equal(itself.observe("lossless26"), by_hand.observe("lossless26"))


def test_a_masked_reset_leaves_the_others_alone():
    kitchens = Kitchens("cramped_room", 3, start="random")
    kitchens.reset(seed=5)
    for joint in joint_actions(seed=2, steps=9, kitchens=3):
        kitchens.step(joint)
    before, seen = all_states(kitchens), kitchens.observe("lossless26")
    kitchens.reset(mask=np.array([False, True, False]))
    after = all_states(kitchens)
    assert (after[0], after[2]) == (before[0], before[2])
    assert (after[1].timestep, after[1].objects) == (0, {})
    np.testing.assert_array_equal(kitchens.observe("lossless26")[[0, 2]], seen[[0, 2]])


def test_an_episode_that_is_over_cannot_be_stepped_without_autoreset():
    kitchens = Kitchens("cramped_room", 2, horizon=3)
    kitchens.autoreset = False
    for _ in range(3):
        result = kitchens.step([[4, 4], [4, 4]])
    assert result.truncated.all()
    before = all_states(kitchens)
    with pytest.raises(ValueError, match=r"kitchen 0 is over after 3 steps; call reset\(\) before step\(\)"):
        kitchens.step([[0, 0], [0, 0]])
    assert all_states(kitchens) == before


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        ([[0, 6], [0, 0]], "kitchen 0, chef 1: action 6; actions are 0 north"),
        ([[0, 0], [-1, 0]], "kitchen 1, chef 0: action -1"),
        ([0, 0], r"the shape \(2,\)"),
        ([[0.0, 1.0], [0.0, 1.0]], r"float64.*whole numbers of the shape \(2, 2\)"),
        ([[True, False], [True, False]], "bool"),
    ],
)
def test_wrong_actions_are_refused_and_nothing_is_played(actions, message):
    kitchens = Kitchens("cramped_room", 2, history=3)
    before, seen = all_states(kitchens), kitchens.observe("stack_states")
    with pytest.raises(ValueError, match=message):
        kitchens.step(actions)
    assert all_states(kitchens) == before
    np.testing.assert_array_equal(kitchens.observe("stack_states"), seen)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"num_kitchens": 0}, "num_kitchens=0; give a whole number from 1"),
        ({"horizon": 0}, "horizon=0; give a whole number of steps from 1"),
        ({"start": "anywhere"}, "start='anywhere'; give 'random' or 'standard'"),
        ({"object_probability": 1.5}, "object_probability=1.5; give a probability"),
        ({"history": -1}, "history=-1; give how many past states to keep"),
        ({"cooking": "slow"}, "cooking='slow'; choose one of 'auto', 'manual'"),
    ],
)
def test_wrong_options_are_named(options, message):
    with pytest.raises(ValueError, match=message):
        Kitchens("cramped_room", **({"num_kitchens": 1} | options))


def test_any_whole_number_type_will_do_for_actions():
    plain, narrow = (Kitchens("cramped_room", 1, start="standard") for _ in range(2))
    for joint in joint_actions(seed=3, steps=20):
        plain.step(joint.tolist())
        narrow.step(joint.astype(np.uint8))
    assert plain.state(0) == narrow.state(0)
