"""States go into a kitchen and out of it, and into overcooked_ai's JSON form and back, unchanged."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench import Chef, Kitchens, KitchenState, Soup
from tests.kitchen.strategies import COOKING, SEEDS, joint_actions, law, layouts, states

OBSERVATIONS = ("lossless26", "features")


@law
@given(st.data())
def test_a_state_survives_json(data):
    state = data.draw(states(data.draw(layouts())))
    assert KitchenState.from_dict(json.loads(json.dumps(state.to_dict()))) == state


@law
@given(st.data(), COOKING)
def test_a_kitchen_gives_back_the_state_it_was_given(data, cooking):
    layout = data.draw(layouts(cooking))
    state = data.draw(states(layout))
    kitchens = Kitchens(layout, 1, cooking=cooking)
    kitchens.set_state(0, state)
    assert kitchens.state(0) == state


@law
@given(st.data(), COOKING, SEEDS)
def test_a_copied_state_looks_and_plays_the_same(data, cooking, seed):
    layout = data.draw(layouts(cooking))
    original, copy = (Kitchens(layout, 1, cooking=cooking, events=True) for _ in range(2))
    original.autoreset = copy.autoreset = False
    original.set_state(0, data.draw(states(layout, horizon=380)))
    *before, last = joint_actions(seed, 12)
    for joint in before:
        original.step(joint)
    copy.set_state(0, original.state(0))
    for name in OBSERVATIONS:
        np.testing.assert_array_equal(original.observe(name), copy.observe(name))
    for ours, theirs in zip(original.step(last), copy.step(last), strict=True):
        np.testing.assert_array_equal(ours, theirs)
    for name in OBSERVATIONS:
        np.testing.assert_array_equal(original.observe(name), copy.observe(name))


GRID = "XXPXX\nO  2O\nX1  X\nXDXSX"
PLAIN = KitchenState((Chef((1, 2)), Chef((3, 1))))


def kitchen() -> Kitchens:
    return Kitchens(GRID, 1, start="standard")


def test_the_reference_json_form_is_read_and_written():
    state = KitchenState(
        (Chef((1, 2), "west", "onion"), Chef((3, 1), "south", Soup((3, 0), 20, 20))),
        {(2, 0): Soup((2, 0)), (0, 0): "dish"},
        timestep=7,
        orders=((3, 0),),
    )
    onion = {"name": "onion", "position": [2, 0]}
    written = state.to_dict()
    assert written["players"][0] == {
        "position": [1, 2],
        "orientation": [-1, 0],
        "held_object": {"name": "onion", "position": [1, 2]},
    }
    assert written["players"][1]["held_object"]["is_ready"] is True
    assert written["objects"][0] == {
        "name": "soup",
        "position": [2, 0],
        "_ingredients": [onion, onion],
        "cooking_tick": -1,
        "_cooking_tick": -1,
        "is_idle": True,
        "is_cooking": False,
        "is_ready": False,
        "cook_time": -1,
    }
    assert written["objects"][1] == {"name": "dish", "position": [0, 0]}
    assert (written["timestep"], written["bonus_orders"]) == (7, [])
    assert written["all_orders"] == [{"ingredients": ["onion", "onion", "onion"]}]


def test_derived_entries_may_be_missing_or_stale_and_one_tick_is_enough():
    soup = {"name": "soup", "position": [2, 0], "_ingredients": [{"name": "onion", "position": [2, 0]}] * 3}
    dishless = {"players": PLAIN.to_dict()["players"]}
    for tick in ({"cooking_tick": 4}, {"_cooking_tick": 4}, {"cooking_tick": 4, "is_idle": True, "is_ready": True}):
        state = KitchenState.from_dict({**dishless, "objects": [soup | tick]})
        kitchens = kitchen()
        kitchens.set_state(0, state)
        assert kitchens.state(0).objects == {(2, 0): Soup((3, 0), 4, 20)}


PLAYERS = PLAIN.to_dict()["players"]


@pytest.mark.parametrize(
    ("data", "message"),
    [
        ({"players": PLAYERS}, "the entry 'objects' is missing"),
        ({"objects": []}, "the entry 'players' is missing"),
        ({"players": PLAYERS[:1], "objects": []}, "1 players; a kitchen here has two"),
        (
            {"players": PLAYERS, "objects": [{"name": "plate", "position": [0, 0]}]},
            "'plate'; names are onion, tomato, dish",
        ),
        (
            {
                "players": PLAYERS,
                "objects": [{"name": "soup", "position": [2, 0], "_ingredients": [], "cooking_tick": -1}],
            },
            "one to three",
        ),
        ([], "not a state in overcooked_ai's JSON form"),
    ],
    ids=["no objects", "no players", "one player", "unknown thing", "empty soup", "a list"],
)
def test_json_that_is_no_state_is_refused(data, message):
    with pytest.raises(ValueError, match=message):
        KitchenState.from_dict(data)


def chefs(**first) -> tuple[Chef, Chef]:
    return replace(PLAIN.chefs[0], **first), PLAIN.chefs[1]


@pytest.mark.parametrize(
    ("state", "message"),
    [
        (replace(PLAIN, chefs=chefs(position=(0, 0))), r"chef 0 stands at \(0, 0\), which is not floor"),
        (replace(PLAIN, chefs=chefs(position=(-1, 2))), r"chef 0 stands at \(-1, 2\), which is not floor"),
        (replace(PLAIN, chefs=chefs(position=(3, 1))), r"both chefs stand at \(3, 1\)"),
        (replace(PLAIN, chefs=chefs(facing="up")), "chef 0 faces 'up'; directions are north, south, east, west"),
        (replace(PLAIN, chefs=chefs(holding="plate")), "things are 'onion', 'tomato', 'dish' and Soup"),
        (replace(PLAIN, chefs=chefs(holding=Soup((3, 0), 3, 20))), "chef 0's soup .* is always finished"),
        (replace(PLAIN, objects={(2, 0): "onion"}), r"onion at \(2, 0\): objects are on counters"),
        (replace(PLAIN, objects={(0, 1): "onion"}), r"onion at \(0, 1\): objects are on counters"),
        (replace(PLAIN, objects={(9, 9): "dish"}), r"dish at \(9, 9\): .* this is 'outside'"),
        (replace(PLAIN, objects={(0, 0): Soup((2, 0))}), r"soup \(2, 0\) at \(0, 0\): .* always finished"),
        (replace(PLAIN, objects={(2, 0): Soup((4, 0))}), "a soup has one to three ingredients"),
        (replace(PLAIN, timestep=401), "timestep 401; the horizon is 400 steps"),
        (replace(PLAIN, timestep=-1), "timestep -1"),
        (replace(PLAIN, orders=((1, 0),)), "the state's orders"),
        (replace(PLAIN, orders=((3, 0),), bonus_orders=((3, 0),)), "the state's bonus"),
    ],
)
def test_an_illegal_state_is_refused_and_changes_nothing(state, message):
    kitchens = kitchen()
    before, seen = kitchens.state(0), kitchens.observe("lossless26")
    with pytest.raises(ValueError, match=message):
        kitchens.set_state(0, state)
    assert kitchens.state(0) == before
    np.testing.assert_array_equal(kitchens.observe("lossless26"), seen)
