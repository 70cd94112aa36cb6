"""What is paid, to whom, and the surprising conditions of the dish reward, by example."""

import pytest

from overcooked_bench import Soup
from tests.kitchen.staging import (
    AT_COUNTER,
    AT_DISHES,
    AT_LEFT_POT,
    AT_ONIONS,
    AT_RIGHT_POT,
    AT_SERVING,
    AWAY,
    COUNTER,
    LEFT_POT,
    RIGHT_POT,
    SOUP,
    act,
    chef,
    held,
    stage,
)

COOKING_SOUP = Soup((3, 0), 4, 20)


def partial(result) -> list[float]:
    return result.partial_reward[0].tolist()


@pytest.mark.parametrize("seat", [0, 1])
def test_the_chef_who_delivers_is_paid(seat):
    chefs = [chef(AT_SERVING, SOUP), chef(AWAY)]
    result = act(stage(chefs[seat], chefs[1 - seat]), *[["interact", "stay"], ["stay", "interact"]][seat])
    assert result.soup_reward[0].tolist() == [20.0 * (seat == 0), 20.0 * (seat == 1)]
    assert partial(result) == [0, 0]


def test_two_deliveries_in_one_step_are_both_paid():
    grid = "XSXSX\nO   P\nX   X\nXDXXX"
    kitchens = stage(chef(((1, 1), "north"), SOUP), chef(((3, 1), "north"), SOUP), grid=grid)
    assert act(kitchens, "interact", "interact").soup_reward[0].tolist() == [20, 20]


@pytest.mark.parametrize(
    ("recipe", "paid"), [((3, 0), 15), ((2, 1), 3 * 12), ((1, 2), 0), ((0, 3), 0), ((1, 0), 0), ((2, 0), 10)]
)
def test_orders_are_paid_bonus_orders_more_and_others_not_at_all(recipe, paid):
    menu = {
        "orders": [["onion"] * 3, ["onion", "tomato", "onion"], ["onion"] * 2],
        "bonus_orders": [["onion", "onion", "tomato"]],
        "order_bonus": 3,
        "soup_reward": {"onion": 5, "tomato": 2},
    }
    kitchens = stage(chef(AT_SERVING, Soup(recipe, 20, 20)), chef(AWAY), cooking="manual", **menu)
    result = act(kitchens, "interact")
    assert result.soup_reward[0].tolist() == [paid, 0]
    assert held(kitchens) == [None, None]


def test_orders_are_never_used_up():
    kitchens = stage(chef(AT_SERVING, SOUP), chef(AWAY))
    state = kitchens.state(0)
    for _ in range(3):
        kitchens.set_state(0, state)
        assert act(kitchens, "interact").soup_reward[0, 0] == 20


@pytest.mark.parametrize("ingredient", ["onion", "tomato"])
def test_any_ingredient_that_goes_into_a_pot_earns_3_even_a_useless_one(ingredient):
    kitchens = stage(chef(AT_LEFT_POT, ingredient), chef(AWAY), {LEFT_POT: Soup((0, 2))})
    assert partial(act(kitchens, "interact")) == [3, 0]


def test_an_ingredient_that_a_full_pot_refuses_earns_nothing():
    kitchens = stage(chef(AT_LEFT_POT, "onion"), chef(AWAY), {LEFT_POT: COOKING_SOUP})
    assert partial(act(kitchens, "interact")) == [0, 0]


@pytest.mark.parametrize("soup", [SOUP, Soup((1, 0), 20, 20)], ids=["ordered", "worthless"])
def test_plating_any_soup_earns_5(soup):
    kitchens = stage(chef(AWAY), chef(AT_LEFT_POT, "dish"), {LEFT_POT: soup})
    assert partial(act(kitchens, "stay", "interact")) == [0, 5]


def test_a_soup_from_a_counter_earns_nothing():
    kitchens = stage(chef(AT_COUNTER), chef(AWAY), {COUNTER: SOUP})
    assert partial(act(kitchens, "interact")) == [0, 0]
    assert held(kitchens)[0] == SOUP


def test_starting_a_pot_earns_nothing():
    kitchens = stage(chef(AT_LEFT_POT), chef(AWAY), {LEFT_POT: Soup((3, 0))}, "manual")
    assert partial(act(kitchens, "interact")) == [0, 0]


@pytest.mark.parametrize(
    ("other_holds", "lying", "earned"),
    [
        (None, {}, 0),
        (None, {LEFT_POT: Soup((1, 0))}, 3),
        (None, {LEFT_POT: Soup((2, 0))}, 3),
        (None, {LEFT_POT: Soup((3, 0))}, 0),
        (None, {LEFT_POT: COOKING_SOUP}, 3),
        (None, {LEFT_POT: SOUP}, 3),
        (None, {LEFT_POT: Soup((0, 1))}, 3),
        ("dish", {LEFT_POT: SOUP}, 0),
        ("dish", {LEFT_POT: SOUP, RIGHT_POT: Soup((1, 0))}, 3),
        ("dish", {LEFT_POT: SOUP, RIGHT_POT: Soup((3, 0))}, 0),
        ("onion", {LEFT_POT: SOUP}, 3),
        (SOUP, {LEFT_POT: SOUP}, 3),
        (None, {LEFT_POT: SOUP, COUNTER: "dish"}, 0),
        (None, {LEFT_POT: SOUP, RIGHT_POT: SOUP, COUNTER: "dish"}, 0),
        (None, {LEFT_POT: SOUP, COUNTER: "onion"}, 3),
        (None, {LEFT_POT: SOUP, COUNTER: SOUP}, 3),
        (None, {COUNTER: SOUP}, 0),
    ],
    ids=[
        *("empty pots", "one onion", "two onions", "three that wait", "cooking", "ready", "tomato"),
        *(
            "other has a dish",
            "a dish for each pot",
            "waiting pot wants none",
            "other has an onion",
            "other has a soup",
        ),
        *(
            "dish on a counter",
            "dish on a counter, two pots",
            "onion on a counter",
            "soup on a counter",
            "no pot in use",
        ),
    ],
)
def test_when_a_dish_is_useful(other_holds, lying, earned):
    kitchens = stage(chef(AT_DISHES), chef(AWAY, other_holds), lying, "manual")
    assert partial(act(kitchens, "interact")) == [earned, 0]
    assert held(kitchens)[0] == "dish"


@pytest.mark.parametrize("recipe", [(1, 0), (2, 0), (3, 0)])
def test_with_automatic_cooking_a_third_ingredient_makes_no_difference_a_step_later(recipe):
    kitchens = stage(chef(AT_DISHES), chef(AWAY), {LEFT_POT: Soup(recipe)}, "auto")
    act(kitchens)
    assert partial(act(kitchens, "interact")) == [3, 0]


# Pots are counted once, at the beginning of the step; counters and hands are read live.


def test_the_pot_that_seat_0_fills_in_this_step_still_counts_for_seat_1():
    kitchens = stage(chef(AT_LEFT_POT, "onion"), chef(AT_DISHES), {LEFT_POT: Soup((2, 0))}, "manual")
    assert partial(act(kitchens, "interact", "interact")) == [3, 3]


def test_the_pot_that_seat_0_begins_in_this_step_does_not_count_yet_for_seat_1():
    kitchens = stage(chef(AT_LEFT_POT, "onion"), chef(AT_DISHES), {}, "manual")
    assert partial(act(kitchens, "interact", "interact")) == [3, 0]


def test_the_pot_that_seat_0_starts_in_this_step_does_not_count_yet_for_seat_1():
    kitchens = stage(chef(AT_LEFT_POT), chef(AT_DISHES), {LEFT_POT: Soup((3, 0))}, "manual")
    assert partial(act(kitchens, "interact", "interact")) == [0, 0]


def test_the_soup_that_seat_0_takes_in_this_step_still_counts_for_seat_1_and_its_dish_does_not():
    kitchens = stage(chef(AT_LEFT_POT, "dish"), chef(AT_DISHES), {LEFT_POT: SOUP})
    assert partial(act(kitchens, "interact", "interact")) == [5, 3]


def test_the_dish_that_seat_0_takes_in_this_step_counts_for_seat_1():
    grid = "XDXDX\nO   P\nX   X\nXSXXX"
    for pots, earned in (({(4, 1): SOUP}, [3, 0]), ({}, [0, 0])):
        kitchens = stage(chef(((1, 1), "north")), chef(((3, 1), "north")), pots, grid=grid)
        assert partial(act(kitchens, "interact", "interact")) == earned


def test_the_dish_that_seat_0_puts_down_in_this_step_counts_as_lying():
    kitchens = stage(chef(AT_COUNTER, "dish"), chef(AT_DISHES), {LEFT_POT: SOUP, RIGHT_POT: SOUP})
    assert partial(act(kitchens, "interact", "interact")) == [0, 0]


def test_the_dish_that_seat_0_picks_up_in_this_step_counts_as_held():
    for pots, earned in (({LEFT_POT: SOUP}, 0), ({LEFT_POT: SOUP, RIGHT_POT: SOUP}, 3)):
        kitchens = stage(chef(AT_COUNTER), chef(AT_DISHES), {**pots, COUNTER: "dish"})
        assert partial(act(kitchens, "interact", "interact")) == [0, earned]


def test_seat_0_does_not_see_what_seat_1_does_in_this_step():
    kitchens = stage(chef(AT_DISHES), chef(AT_COUNTER, "dish"), {LEFT_POT: SOUP})
    assert partial(act(kitchens, "interact", "interact")) == [0, 0]  # seat 1 still holds its dish


def test_one_step_pays_each_chef_for_its_own_work():
    kitchens = stage(chef(AT_LEFT_POT, "dish"), chef(AT_RIGHT_POT, "onion"), {LEFT_POT: SOUP})
    assert partial(act(kitchens, "interact", "interact")) == [5, 3]
    idle = stage(chef(AT_ONIONS), chef(AWAY))
    assert partial(act(idle, "interact", "north")) == [0, 0]
