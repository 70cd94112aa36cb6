"""Observations: pure, the same into a buffer, and stacks made of recorded single observations."""

from collections import deque
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench import Chef, Kitchens, KitchenState, Soup
from overcooked_bench.kitchen.image import CHANNELS
from overcooked_bench.kitchen.observations.blind import BLIND_CHANNELS
from overcooked_bench.kitchen.observations.grid import ONION_CHANNELS
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS
from overcooked_bench.kitchen.observations.stack_channels import PAST_CHANNELS
from tests.kitchen.strategies import SEEDS, joint_actions, law, layouts, states

ALL = tuple(OBSERVATIONS)


@law
@given(st.data(), SEEDS)
def test_a_buffer_gets_what_a_fresh_array_shows_and_looking_changes_nothing(data, seed):
    layout = data.draw(layouts(tomatoes=False))
    kitchens = Kitchens(layout, 2, cooking="manual", history=3)
    for joint in joint_actions(seed, 5, kitchens=2):
        kitchens.step(joint)
    before = [kitchens.state(i) for i in range(2)]
    for name in ALL:
        fresh = kitchens.observe(name)
        assert fresh.shape == (2, 2, *kitchens.observation_shape(name))
        buffer = np.full_like(fresh, 77)
        assert kitchens.observe(name, out=buffer) is buffer
        np.testing.assert_array_equal(buffer, fresh)
        fresh[...] = 99
        np.testing.assert_array_equal(kitchens.observe(name), buffer)
    assert [kitchens.state(i) for i in range(2)] == before


@law
@given(st.data(), SEEDS)
def test_lossless_is_lossless26_without_the_tomato_channels(data, seed):
    kitchens = Kitchens(data.draw(layouts(tomatoes=False)), 2, cooking="manual", object_probability=0.6)
    for joint in joint_actions(seed, 15, kitchens=2):
        kitchens.step(joint)
        full = kitchens.observe("lossless26")
        np.testing.assert_array_equal(kitchens.observe("lossless"), full[:, :, ONION_CHANNELS])
        assert not full[:, :, [k for k in range(26) if k not in ONION_CHANNELS]].any()


def test_the_onion_channels_are_all_but_the_four_of_tomatoes():
    assert tuple(k for k in range(26) if k not in (13, 17, 19, 24)) == ONION_CHANNELS


@law
@given(st.data(), st.integers(0, 1))
def test_a_blind_chef_sees_the_kitchen_and_nothing_of_its_partner(data, seat):
    layout = data.draw(layouts(tomatoes=False))
    kitchens = Kitchens(layout, 3, cooking="manual")
    state, elsewhere = data.draw(states(layout)), data.draw(states(layout))
    other = next(chef for chef in elsewhere.chefs if chef.position != state.chefs[seat].position)
    for i, partner in enumerate((state.chefs[1 - seat], other, replace(other, holding=None))):
        chefs = (state.chefs[seat], partner)
        kitchens.set_state(i, replace(state, chefs=chefs if seat == 0 else chefs[::-1]))
    views = kitchens.observe("blind")[:, seat]
    np.testing.assert_array_equal(views[1:], views[[0, 0]])
    np.testing.assert_array_equal(views[2], kitchens.observe("lossless26")[2, seat, list(BLIND_CHANNELS)])


def test_what_a_blind_chef_misses_is_where_its_partner_stands_and_looks():
    missing = [CHANNELS[k] for k in ONION_CHANNELS if k not in BLIND_CHANNELS]
    assert missing == ["other_position", *(f"other_faces_{way}" for way in ("north", "south", "east", "west"))]


@law
@given(st.data(), SEEDS)
def test_stacks_are_the_recorded_past(data, seed):
    layout = data.draw(layouts(tomatoes=False))
    kitchens = Kitchens(layout, 2, cooking="manual", horizon=9, history=3, object_probability=0.5)
    kitchens.reset(seed=seed)
    first = kitchens.observe("lossless")
    past = [deque([first[i]] * 4, maxlen=4) for i in range(2)]
    for step, joint in enumerate(joint_actions(seed, 30, kitchens=2)):
        result = kitchens.step(joint)
        restarted = result.truncated.copy()
        if step in (13, 14):
            kitchens.set_state(1, data.draw(states(layout, horizon=9)))
            restarted[1] = True
        if step == 20:
            kitchens.reset(mask=np.array([True, False]))
            restarted[0] = True
        now = kitchens.observe("lossless")
        for i in range(2):
            past[i].extend([now[i]] * (4 if restarted[i] else 1))
        newest_first = np.stack([np.stack(list(past[i])[::-1], axis=1) for i in range(2)])
        np.testing.assert_array_equal(kitchens.observe("stack_states"), newest_first)
        flat = [newest_first[:, :, 0], *(newest_first[:, :, age, list(PAST_CHANNELS)] for age in (1, 2, 3))]
        np.testing.assert_array_equal(kitchens.observe("stack_channels"), np.concatenate(flat, axis=2))


@law
@given(st.data(), SEEDS, st.lists(st.integers(0, 1), min_size=4, max_size=4))
def test_one_chefs_view_is_that_half_of_both(data, seed, seats):
    layout = data.draw(layouts(tomatoes=False))
    kitchens = Kitchens(layout, 4, cooking="manual", history=3, object_probability=0.5)
    for joint in joint_actions(seed, 5, kitchens=4):
        kitchens.step(joint)
    chosen = np.array(seats)
    for name in ALL:
        both = kitchens.observe(name)
        np.testing.assert_array_equal(kitchens.observe(name, seats=chosen), both[np.arange(4), chosen])
        buffer = np.full_like(both[:, 0], 77)
        assert kitchens.observe(name, out=buffer, seats=chosen) is buffer
        np.testing.assert_array_equal(buffer, both[np.arange(4), chosen])
        some = np.array([2, 0, 2, 3])
        np.testing.assert_array_equal(kitchens.observe_some(name, some, chosen), both[some, chosen])


def test_a_stack_right_after_reset_repeats_the_first_state():
    kitchens = Kitchens("cramped_room", 3, history=3)
    kitchens.reset(seed=1)
    stack = kitchens.observe("stack_states")
    assert stack.shape == (3, 2, 4, 22, 4, 5)
    for age in range(4):
        np.testing.assert_array_equal(stack[:, :, age], kitchens.observe("lossless"))


def test_every_channel_of_a_described_kitchen():
    grid = "XXPTX\nO  2P\nX1  X\nXDXSX"
    kitchens = Kitchens(grid, 1, cooking="manual", start="standard", horizon=100)
    state = KitchenState(
        (Chef((1, 1), "west", Soup((1, 2), 20, 20)), Chef((3, 2), "south", "dish")),
        {
            (2, 0): Soup((2, 1)),
            (4, 1): Soup((1, 2), 5, 20),
            (0, 0): "onion",
            (1, 0): "tomato",
            (0, 2): "dish",
            (4, 2): Soup((3, 0), 20, 20),
        },
        timestep=61,
    )
    kitchens.set_state(0, state)
    view = kitchens.observe("lossless26")[0, 1]
    shown = {
        name: {(int(x), int(y)): int(view[k, y, x]) for y, x in np.argwhere(view[k])} for k, name in enumerate(CHANNELS)
    }
    counters = [(0, 0), (1, 0), (4, 0), (0, 2), (4, 2), (0, 3), (2, 3), (4, 3)]
    expected = {
        "own_position": {(3, 2): 1},
        "other_position": {(1, 1): 1},
        "own_faces_south": {(3, 2): 1},
        "other_faces_west": {(1, 1): 1},
        "pots": {(2, 0): 1, (4, 1): 1},
        "counters": dict.fromkeys(counters, 1),
        "onion_dispensers": {(0, 1): 1},
        "tomato_dispensers": {(3, 0): 1},
        "dish_dispensers": {(1, 3): 1},
        "serving_tiles": {(3, 3): 1},
        "onions_in_pot": {(2, 0): 2},
        "tomatoes_in_pot": {(2, 0): 1},
        "onions_in_soup": {(4, 1): 1, (4, 2): 3, (1, 1): 1},
        "tomatoes_in_soup": {(4, 1): 2, (1, 1): 2},
        "cook_time_remaining": {(4, 1): 15},
        "soup_done": {(4, 2): 1, (1, 1): 1},
        "dishes": {(3, 2): 1, (0, 2): 1},
        "onions": {(0, 0): 1},
        "tomatoes": {(1, 0): 1},
        "urgency": {(x, y): 1 for x in range(5) for y in range(4)},
    }
    assert shown == {name: expected.get(name, {}) for name in CHANNELS}


@pytest.mark.parametrize(("horizon", "first_urgent"), [(100, 61), (400, 361), (40, 1), (39, 0), (5, 0)])
def test_the_last_39_steps_are_urgent(horizon, first_urgent):
    kitchens = Kitchens("cramped_room", 1, horizon=horizon)
    kitchens.autoreset = False
    urgent = [kitchens.observe("lossless")[0, 0, -1]]
    for _ in range(horizon):
        kitchens.step([[4, 4]])
        urgent.append(kitchens.observe("lossless")[0, 0, -1])
    assert all((plane == plane[0, 0]).all() for plane in urgent)
    assert [int(plane[0, 0]) for plane in urgent] == [int(t >= first_urgent) for t in range(horizon + 1)]


@pytest.mark.parametrize(
    ("layout", "name", "message"),
    [
        ("cramped_room", "pixels", "no observation named 'pixels'; choose one of blind, features, jaxmarl, lossless, "),
        ("cramped_room", "stack_states", "'stack_states' needs the past: make Kitchens"),
        ("cramped_room", "stack_channels", "'stack_channels' needs the past"),
        (
            "XTPXX\nO  2O\nX1  X\nXDXSX",
            "lossless",
            "no tomato channels, and this layout has tomatoes; use 'lossless26'",
        ),
    ],
)
def test_what_cannot_be_shown_is_refused(layout, name, message):
    with pytest.raises(ValueError, match=message):
        Kitchens(layout, 1).observe(name)


@pytest.mark.parametrize(
    "out",
    [
        np.zeros((1, 2, 22, 4, 5), np.int64),
        np.zeros((2, 2, 22, 4, 5), np.uint8),
        np.zeros((1, 2, 22, 5, 4), np.uint8).swapaxes(3, 4),
    ],
    ids=["type", "shape", "not contiguous"],
)
def test_a_wrong_buffer_is_refused(out):
    with pytest.raises(ValueError, match="'lossless' needs a contiguous uint8"):
        Kitchens("cramped_room", 1).observe("lossless", out=out)
