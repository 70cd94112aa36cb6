"""The 25 events by example, with the reference's quirks."""

import numpy as np
import pytest

from overcooked_bench import Kitchens, Soup
from overcooked_bench.kitchen.events import EVENTS
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
    logged,
    stage,
)

FULL = {LEFT_POT: Soup((3, 0)), RIGHT_POT: Soup((3, 0), 4, 20)}
HALF_FULL = {LEFT_POT: Soup((3, 0))}


def happens(place, holding, lying=None, other=None, cooking="manual", **menu) -> set[str]:
    """The events of one interaction by seat 1; nothing is logged for seat 0, who holds `other`."""
    result = act(stage(chef(AWAY, other), chef(place, holding), lying, cooking, **menu), "stay", "interact")
    assert logged(result, 0) == set()
    return logged(result, 1)


def test_events_are_given_only_where_they_are_asked_for():
    kitchens = Kitchens("cramped_room", 2)
    assert kitchens.step(np.full((2, 2), 5)).events is None
    assert len(EVENTS) == len(set(EVENTS)) == 25


@pytest.mark.parametrize(
    ("pots", "other", "wanted"),
    [
        ({}, None, True),
        (HALF_FULL, None, True),
        ({**HALF_FULL, RIGHT_POT: Soup((2, 0))}, None, True),
        (FULL, None, False),
        ({LEFT_POT: SOUP, RIGHT_POT: SOUP}, "onion", False),
        (FULL, "dish", True),
    ],
    ids=["empty pots", "one full", "one full, one not", "all full", "all ready", "all full, but the other has a dish"],
)
@pytest.mark.parametrize("ingredient", ["onion", "tomato"])
def test_an_ingredient_is_useful_unless_all_pots_are_full_and_the_other_has_no_dish(ingredient, pots, other, wanted):
    taken, dropped = f"{ingredient}_pickup", f"{ingredient}_drop"
    pickup = happens(AT_COUNTER, None, {**pots, COUNTER: ingredient}, other)
    assert pickup == {taken} | ({f"useful_{taken}"} if wanted else set())
    drop = happens(AT_COUNTER, ingredient, pots, other)
    assert drop == {dropped} | (set() if wanted else {f"useful_{dropped}"})


def test_an_onion_from_the_dispenser_is_logged_and_a_tomato_is_not():
    assert happens(AT_ONIONS, None) == {"onion_pickup", "useful_onion_pickup"}
    assert happens(AT_ONIONS, None, FULL) == {"onion_pickup"}
    assert happens(AT_TOMATOES, None) == set()


def test_a_dish_from_the_dispenser_is_useful_when_it_is_rewarded():
    assert happens(AT_DISHES, None) == {"dish_pickup"}
    assert happens(AT_DISHES, None, HALF_FULL) == {"dish_pickup"}
    assert happens(AT_DISHES, None, {LEFT_POT: SOUP}) == {"dish_pickup", "useful_dish_pickup"}
    assert happens(AT_DISHES, None, {LEFT_POT: SOUP}, other="dish") == {"dish_pickup"}


def test_a_dish_from_a_counter_is_never_useful_for_it_still_lies_there():
    assert happens(AT_COUNTER, None, {LEFT_POT: SOUP, COUNTER: "dish"}) == {"dish_pickup"}


@pytest.mark.parametrize(
    ("pots", "other", "useful"),
    [
        ({}, None, True),
        ({LEFT_POT: Soup((2, 0))}, "dish", True),
        ({}, "onion", False),
        ({}, "tomato", True),
        (HALF_FULL, None, False),
        ({RIGHT_POT: SOUP}, None, False),
    ],
)
def test_dropping_a_dish_is_useful_while_no_pot_is_full_and_the_other_has_no_onion(pots, other, useful):
    assert happens(AT_COUNTER, "dish", pots, other) == {"dish_drop"} | ({"useful_dish_drop"} if useful else set())


def test_soups_are_picked_up_from_pots_and_counters_dropped_and_delivered():
    assert happens(AT_LEFT_POT, "dish", {LEFT_POT: SOUP}) == {"soup_pickup"}
    assert happens(AT_COUNTER, None, {COUNTER: SOUP}) == {"soup_pickup"}
    assert happens(AT_COUNTER, SOUP) == {"soup_drop"}
    assert happens(AT_SERVING, SOUP) == {"soup_delivery"}


def test_a_worthless_soup_is_delivered_too():
    assert happens(AT_SERVING, Soup((1, 0), 20, 20)) == {"soup_delivery"}


@pytest.mark.parametrize(
    ("place", "holding", "lying"),
    [
        (AT_LEFT_POT, None, {LEFT_POT: Soup((3, 0))}),
        (AT_LEFT_POT, "onion", {LEFT_POT: Soup((3, 0))}),
        (AT_LEFT_POT, "dish", {}),
        (AT_SERVING, "dish", {}),
        (AT_ONIONS, "onion", {}),
        (AT_COUNTER, None, {}),
        (AT_COUNTER, "onion", {COUNTER: "onion"}),
    ],
    ids=["start", "full pot", "empty pot", "serve a dish", "give back", "empty counter", "blocked"],
)
def test_starting_a_pot_and_doing_nothing_are_no_events(place, holding, lying):
    assert happens(place, holding, lying) == set()


MIXED = {
    "orders": [["onion"] * 3, ["onion", "onion", "tomato"]],
    "bonus_orders": [["onion", "onion", "tomato"]],
}


@pytest.mark.parametrize(
    ("menu", "before", "added", "quality"),
    [
        ({}, (0, 0), "onion", {"optimal", "viable"}),
        ({}, (2, 0), "onion", {"optimal", "viable"}),
        ({}, (0, 0), "tomato", {"catastrophic"}),
        ({}, (2, 0), "tomato", {"catastrophic"}),
        ({}, (0, 1), "onion", {"optimal", "useless"}),
        ({}, (1, 1), "tomato", {"optimal", "useless"}),
        (MIXED, (2, 0), "tomato", {"optimal", "viable"}),
        (MIXED, (2, 0), "onion", {"viable"}),
        (MIXED, (1, 0), "onion", {"optimal", "viable"}),
        (MIXED, (1, 1), "tomato", {"catastrophic"}),
    ],
)
def test_the_quality_of_an_ingredient_in_a_pot(menu, before, added, quality):
    lying = {LEFT_POT: Soup(before)} if any(before) else {}
    expected = {f"potting_{added}"} | {f"{word}_{added}_potting" for word in quality}
    assert happens(AT_LEFT_POT, added, lying, **menu) == expected


def test_pots_are_judged_as_they_were_when_the_step_began():
    pots = {LEFT_POT: Soup((2, 0)), RIGHT_POT: Soup((3, 0))}
    kitchens = stage(chef(AT_LEFT_POT, "onion"), chef(AT_COUNTER, "onion"), pots, "manual")
    result = act(kitchens, "interact", "interact")
    assert logged(result, 0) == {"potting_onion", "optimal_onion_potting", "viable_onion_potting"}
    assert logged(result, 1) == {"onion_drop"}  # only now are all pots full


def test_hands_are_judged_as_they_are_now():
    pots = {LEFT_POT: SOUP, RIGHT_POT: Soup((3, 0))}
    kitchens = stage(chef(AT_LEFT_POT, "dish"), chef(AT_COUNTER, "onion"), pots, "manual")
    result = act(kitchens, "interact", "interact")
    assert logged(result, 0) == {"soup_pickup"}
    assert logged(result, 1) == {"onion_drop", "useful_onion_drop"}  # the dish is gone, the pot still counts as full


def test_both_chefs_events_are_their_own():
    kitchens = stage(chef(AT_ONIONS), chef(AT_RIGHT_POT, "onion"))
    result = act(kitchens, "interact", "interact")
    assert logged(result, 0) == {"onion_pickup", "useful_onion_pickup"}
    assert logged(result, 1) == {"potting_onion", "optimal_onion_potting", "viable_onion_potting"}
