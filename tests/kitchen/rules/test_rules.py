"""The rules of the game by example: interactions, their order within a step, cooking, movement."""

import pytest

from overcooked_bench import Soup
from tests.kitchen.staging import (
    AT_COUNTER,
    AT_DISHES,
    AT_LEFT_POT,
    AT_ONIONS,
    AT_RIGHT_POT,
    AT_SERVING,
    AT_TOMATOES,
    AWAY,
    COUNTER,
    LEFT_POT,
    RIGHT_POT,
    SOUP,
    act,
    chef,
    facings,
    held,
    objects,
    places,
    stage,
)

ISLAND = "XXXDX\nO P X\nX X S\nXXXXX"
ISLAND_POT, ISLAND_WEST, ISLAND_EAST = (2, 1), ((1, 1), "east"), ((3, 1), "west")
"""A pot that both chefs face."""

BOTH = pytest.mark.parametrize("cooking", ["auto", "manual"])
THINGS = ["onion", "tomato", "dish", SOUP]


@BOTH
@pytest.mark.parametrize(
    ("place", "holding", "lying", "holding_after", "lying_after"),
    [
        *((AT_COUNTER, thing, {}, None, {COUNTER: thing}) for thing in THINGS),
        *((AT_COUNTER, None, {COUNTER: thing}, thing, {}) for thing in THINGS),
        (AT_COUNTER, "onion", {COUNTER: "dish"}, "onion", {COUNTER: "dish"}),
        (AT_COUNTER, "dish", {COUNTER: SOUP}, "dish", {COUNTER: SOUP}),
        (AT_COUNTER, None, {}, None, {}),
        *(
            (place, None, {}, thing, {})
            for place, thing in ((AT_ONIONS, "onion"), (AT_TOMATOES, "tomato"), (AT_DISHES, "dish"))
        ),
        *((place, thing, {}, thing, {}) for place in (AT_ONIONS, AT_TOMATOES, AT_DISHES) for thing in THINGS),
        (AT_LEFT_POT, "onion", {}, None, {LEFT_POT: Soup((1, 0))}),
        (AT_LEFT_POT, "tomato", {}, None, {LEFT_POT: Soup((0, 1))}),
        (AT_LEFT_POT, "onion", {LEFT_POT: Soup((0, 1))}, None, {LEFT_POT: Soup((1, 1))}),
        (AT_LEFT_POT, "onion", {LEFT_POT: Soup((3, 0), 4, 20)}, "onion", {LEFT_POT: Soup((3, 0), 5, 20)}),
        (AT_LEFT_POT, "onion", {LEFT_POT: Soup((1, 0), 4, 20)}, "onion", {LEFT_POT: Soup((1, 0), 5, 20)}),
        (AT_LEFT_POT, "tomato", {LEFT_POT: SOUP}, "tomato", {LEFT_POT: SOUP}),
        (AT_LEFT_POT, "dish", {}, "dish", {}),
        (AT_LEFT_POT, "dish", {LEFT_POT: Soup((2, 0))}, "dish", {LEFT_POT: Soup((2, 0))}),
        (AT_LEFT_POT, "dish", {LEFT_POT: Soup((3, 0), 18, 20)}, "dish", {LEFT_POT: Soup((3, 0), 19, 20)}),
        (AT_LEFT_POT, "dish", {LEFT_POT: SOUP}, SOUP, {}),
        (AT_LEFT_POT, SOUP, {}, SOUP, {}),
        (AT_LEFT_POT, SOUP, {LEFT_POT: Soup((1, 0))}, SOUP, {LEFT_POT: Soup((1, 0))}),
        (AT_LEFT_POT, None, {}, None, {}),
        (AT_LEFT_POT, None, {LEFT_POT: SOUP}, None, {LEFT_POT: SOUP}),
        (AT_SERVING, SOUP, {}, None, {}),
        *((AT_SERVING, thing, {}, thing, {}) for thing in (None, "onion", "tomato", "dish")),
        (((2, 2), "north"), "onion", {}, "onion", {}),
    ],
)
def test_what_an_interaction_does(cooking, place, holding, lying, holding_after, lying_after):
    kitchens = stage(chef(place, holding), chef(AWAY), lying, cooking)
    act(kitchens, "interact")
    assert held(kitchens)[0] == holding_after
    assert objects(kitchens) == lying_after
    assert places(kitchens)[0] == place[0]


def test_a_pot_with_three_ingredients_takes_no_fourth():
    kitchens = stage(chef(AT_LEFT_POT, "onion"), chef(AWAY), {LEFT_POT: Soup((3, 0))}, "manual")
    act(kitchens, "interact")
    assert held(kitchens)[0] == "onion"
    assert objects(kitchens) == {LEFT_POT: Soup((3, 0))}


# Cooking.


@pytest.mark.parametrize("recipe", [(1, 0), (2, 0), (3, 0), (0, 2), (1, 1)])
def test_manual_an_empty_hand_starts_any_pot_that_is_not_empty(recipe):
    kitchens = stage(chef(AT_LEFT_POT), chef(AWAY), {LEFT_POT: Soup(recipe)}, "manual")
    act(kitchens, "interact")
    assert objects(kitchens) == {LEFT_POT: Soup(recipe, 1, 20)}
    act(kitchens, "interact")
    assert objects(kitchens) == {LEFT_POT: Soup(recipe, 2, 20)}


def test_auto_an_empty_hand_does_nothing_and_partial_soups_never_start():
    kitchens = stage(chef(AT_LEFT_POT), chef(AWAY), {LEFT_POT: Soup((2, 0))}, "auto")
    for _ in range(30):
        act(kitchens, "interact")
    assert objects(kitchens) == {LEFT_POT: Soup((2, 0))}


def test_auto_a_third_ingredient_starts_the_pot_and_a_full_idle_pot_starts_by_itself():
    kitchens = stage(chef(AT_LEFT_POT, "onion"), chef(AWAY), {LEFT_POT: Soup((2, 0)), RIGHT_POT: Soup((3, 0))}, "auto")
    act(kitchens, "interact")
    assert objects(kitchens) == {LEFT_POT: Soup((3, 0), 1, 20), RIGHT_POT: Soup((3, 0), 1, 20)}


def test_manual_a_full_pot_waits_for_a_hand():
    kitchens = stage(chef(AT_LEFT_POT, "onion"), chef(AWAY), {LEFT_POT: Soup((2, 0))}, "manual")
    for _ in range(5):
        act(kitchens, "interact")
        if held(kitchens)[0] is None:
            act(kitchens, "west", "stay")
    assert objects(kitchens) == {LEFT_POT: Soup((3, 0))}


@BOTH
@pytest.mark.parametrize("cook_time", [1, 2, 20, 33])
def test_a_soup_can_be_taken_cook_time_steps_after_it_starts_and_not_before(cooking, cook_time):
    content, hand = {"auto": (Soup((2, 0)), "onion"), "manual": (Soup((3, 0)), None)}[cooking]
    first, second = chef(ISLAND_WEST, hand), chef(ISLAND_EAST, "dish")
    kitchens = stage(first, second, {ISLAND_POT: content}, cooking, ISLAND, cook_time=cook_time)
    act(kitchens, "interact", "interact")
    assert objects(kitchens) == {ISLAND_POT: Soup((3, 0), 1, cook_time)}
    taken = []
    for _ in range(cook_time):
        act(kitchens, "stay", "interact")
        taken.append(isinstance(held(kitchens)[1], Soup))
    assert taken == [False] * (cook_time - 1) + [True]


def test_a_ready_soup_waits_for_ever():
    kitchens = stage(chef(AT_ONIONS), chef(AWAY), {LEFT_POT: Soup((3, 0), 15, 20), COUNTER: SOUP})
    for _ in range(50):
        act(kitchens)
    assert objects(kitchens) == {LEFT_POT: SOUP, COUNTER: SOUP}


def test_the_cook_time_is_that_of_the_recipe():
    times = {"orders": [["onion"] * 3, ["tomato"] * 3], "cook_time": {"onion": 4, "tomato": 7}}
    kitchens = stage(chef(AT_LEFT_POT), chef(AT_RIGHT_POT), {LEFT_POT: Soup((2, 1)), RIGHT_POT: Soup((0, 3))}, **times)
    act(kitchens)
    assert objects(kitchens) == {LEFT_POT: Soup((2, 1), 1, 15), RIGHT_POT: Soup((0, 3), 1, 21)}


# Two chefs in one step: seat 0 first.


def test_manual_seat_0_fills_and_seat_1_starts_in_the_same_step():
    kitchens = stage(chef(ISLAND_WEST, "onion"), chef(ISLAND_EAST), {ISLAND_POT: Soup((2, 0))}, "manual", ISLAND)
    act(kitchens, "interact", "interact")
    assert objects(kitchens) == {ISLAND_POT: Soup((3, 0), 1, 20)}
    assert held(kitchens) == [None, None]


def test_manual_seat_0_starts_two_onions_and_seat_1_keeps_the_third():
    kitchens = stage(chef(ISLAND_WEST), chef(ISLAND_EAST, "onion"), {ISLAND_POT: Soup((2, 0))}, "manual", ISLAND)
    act(kitchens, "interact", "interact")
    assert objects(kitchens) == {ISLAND_POT: Soup((2, 0), 1, 20)}
    assert held(kitchens) == [None, "onion"]


PASS = "XPXXX\nO X D\nX X S\nXXXXX"
"""Two rooms that share the counter (2, 1)."""


@pytest.mark.parametrize(
    ("hands", "lying", "hands_after", "lying_after"),
    [
        (("onion", None), None, (None, "onion"), None),
        ((None, "onion"), None, (None, None), "onion"),
        ((None, "dish"), "onion", ("onion", None), "dish"),
        (("dish", None), "onion", ("dish", "onion"), None),
        (("onion", "dish"), None, (None, "dish"), "onion"),
        ((None, None), "onion", ("onion", None), None),
        (("dish", "dish"), "onion", ("dish", "dish"), "onion"),
    ],
    ids=[
        "pass on",
        "too late to pass",
        "take, then drop",
        "blocked, then take",
        "both drop",
        "both take",
        "both blocked",
    ],
)
def test_hand_overs_in_one_step(hands, lying, hands_after, lying_after):
    counter = (2, 1)
    first, second = chef(((1, 1), "east"), hands[0]), chef(((3, 1), "west"), hands[1])
    kitchens = stage(first, second, {counter: lying} if lying else {}, grid=PASS)
    act(kitchens, "interact", "interact")
    assert tuple(held(kitchens)) == hands_after
    assert objects(kitchens).get(counter) == lying_after


def test_chefs_cannot_pass_things_from_hand_to_hand():
    kitchens = stage(chef(((2, 2), "east"), "onion"), chef(((3, 2), "west")))
    act(kitchens, "interact", "interact")
    assert held(kitchens) == ["onion", None]


def test_an_interaction_happens_where_the_chef_stood_and_looked_before_the_step():
    kitchens = stage(chef(AT_COUNTER, "onion"), chef(((2, 3), "south"), "dish"))
    act(kitchens, "interact", "west")
    assert objects(kitchens) == {COUNTER: "onion"}
    assert places(kitchens) == [(1, 3), (2, 3)]
    act(kitchens, "north", "interact")
    assert held(kitchens) == [None, "dish"]  # seat 1 now looks west, at a chef who has left


# Movement.


@pytest.mark.parametrize(
    ("starts", "actions", "ends"),
    [
        (((1, 2), (3, 3)), ("east", "west"), ((2, 2), (2, 3))),
        (((1, 2), (2, 2)), ("east", "east"), ((2, 2), (3, 2))),
        (((2, 2), (1, 2)), ("east", "east"), ((3, 2), (2, 2))),
        (((1, 2), (2, 2)), ("east", "north"), ((2, 2), (2, 1))),
        (((1, 2), (2, 2)), ("east", "stay"), ((1, 2), (2, 2))),
        (((1, 2), (2, 2)), ("east", "interact"), ((1, 2), (2, 2))),
        (((1, 2), (2, 2)), ("east", "west"), ((1, 2), (2, 2))),
        (((1, 2), (3, 2)), ("east", "west"), ((1, 2), (3, 2))),
        (((1, 1), (2, 2)), ("east", "north"), ((1, 1), (2, 2))),
        (((3, 1), (4, 1)), ("east", "east"), ((3, 1), (4, 1))),
        (((1, 1), (2, 3)), ("west", "south"), ((1, 1), (2, 3))),
        (((1, 1), (2, 1)), ("west", "west"), ((1, 1), (2, 1))),
    ],
    ids=[
        *("free", "seat 0 follows", "seat 1 follows", "into a cell that is left", "into one that stays"),
        *("into one that interacts", "swap", "same cell head on", "same cell round a corner", "follow into a wall"),
        *("walls", "collide with a blocked"),
    ],
)
def test_movement(starts, actions, ends):
    kitchens = stage(chef((starts[0], "north"), "onion"), chef((starts[1], "south")))
    act(kitchens, *actions)
    assert tuple(places(kitchens)) == ends
    turned = [action if action in ("north", "south", "east", "west") else None for action in actions]
    assert facings(kitchens) == [turned[0] or "north", turned[1] or "south"]
    assert held(kitchens) == ["onion", None]
