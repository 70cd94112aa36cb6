import pytest

from overcooked_bench.agents.behaviours.parsing import parse_behaviour
from overcooked_bench.kitchen.events import EVENTS
from overcooked_bench.kitchen.state import Soup
from tests.agents.behaviours.kitchens import COOKING, READY, Watched

RING, ROOM, FORCED, CIRCUIT = "coordination_ring", "cramped_room", "forced_coordination", "counter_circuit"
SHARED = [[2, 1], [2, 2], [2, 3]]
FAR = ((1, 1), "north")


def did(kitchen, event):
    return int(kitchen.events[1, EVENTS.index(event)])


def test_an_onion_goes_to_the_fullest_of_the_nearest_pots():
    kitchen = Watched(RING, ((2, 1), "east", "onion"), FAR, {(4, 1): Soup((2, 0))})
    assert kitchen.play(parse_behaviour({"does": "carry"}), 3) == [2, 5, 4]
    assert kitchen.state.objects[4, 1].tick == 2


def test_a_dish_waits_at_a_pot_that_cooks_and_the_soup_is_served():
    kitchen = Watched(ROOM, ((3, 1), "north", "dish"), ((1, 2), "north"), {(2, 0): COOKING})
    actions = kitchen.play(parse_behaviour({"does": "carry"}), 20)
    assert actions[:2] == [3, 0]
    assert actions[2:15] == [4] * 13
    assert (did(kitchen, "soup_pickup"), did(kitchen, "soup_delivery")) == (1, 1)
    assert kitchen.me.holding is None


def test_what_cannot_be_used_is_kept():
    kitchen = Watched(ROOM, ((3, 1), "north", "dish"), ((1, 2), "north"))
    assert kitchen.play(parse_behaviour({"does": "carry", "insist": True}), 5) == [4] * 5
    kitchen = Watched(ROOM, ((3, 1), "north", "onion"), ((1, 2), "north"), {(2, 0): READY})
    assert kitchen.play(parse_behaviour({"does": "onions"}), 5) == [4] * 5


def test_when_there_is_nothing_left_to_do_something_else_follows():
    kitchen = Watched(ROOM, ((2, 1), "north", "onion"), ((1, 2), "north"))
    kitchen.play(parse_behaviour({"does": "carry", "then": [3, 2]}), 6)
    assert did(kitchen, "potting_onion") == 1
    assert kitchen.me.position == (3, 2)


def test_onions_until_the_pot_is_full():
    kitchen = Watched(ROOM, ((3, 2), "north"), ((1, 2), "north"))
    kitchen.play(parse_behaviour({"does": "onions"}), 60)
    assert (did(kitchen, "onion_pickup"), did(kitchen, "potting_onion"), did(kitchen, "dish_pickup")) == (3, 3, 0)


def test_a_plater_does_the_rest():
    kitchen = Watched(ROOM, ((3, 2), "north"), ((1, 1), "north"))
    assert kitchen.play(parse_behaviour({"does": "plater"}), 3) == [4] * 3
    kitchen = Watched(ROOM, ((3, 2), "north"), ((1, 1), "north"), {(2, 0): COOKING})
    kitchen.play(parse_behaviour({"does": "plater"}), 30)
    assert (did(kitchen, "dish_pickup"), did(kitchen, "soup_delivery"), did(kitchen, "onion_pickup")) == (1, 1, 0)


def test_a_receiver_takes_what_is_of_use_and_leaves_the_rest():
    receiver = parse_behaviour({"does": "receiver", "counters": SHARED})
    pots = {(3, 0): READY, (4, 1): READY}
    clutter = {(2, 1): "onion", (2, 2): "onion"}
    kitchen = Watched(FORCED, ((3, 3), "north"), ((1, 2), "north"), pots | clutter)
    assert kitchen.play(receiver, 4) == [4] * 4
    kitchen = Watched(FORCED, ((3, 3), "north"), ((1, 2), "north"), pots | clutter | {(2, 3): "dish"})
    kitchen.play(receiver, 6)
    assert did(kitchen, "soup_pickup") == 1
    assert {cell: kitchen.state.objects.get(cell) for cell in clutter} == clutter
    kitchen = Watched(FORCED, ((3, 3), "north"), ((1, 2), "north"), {(3, 0): Soup((2, 0)), (2, 2): "onion"})
    kitchen.play(receiver, 8)
    assert did(kitchen, "potting_onion") == 1


@pytest.mark.parametrize("item", ["onion", "dish"])
def test_a_dumper_fills_its_counters_and_stops(item):
    dumper = parse_behaviour({"does": "dumper", "counters": SHARED, "item": item})
    kitchen = Watched(FORCED, ((1, 1), "north"), ((3, 1), "north"))
    kitchen.play(dumper, 40)
    assert [kitchen.state.objects.get((2, y)) for y in (1, 2, 3)] == [item] * 3
    assert kitchen.play(dumper, 3) == [4] * 3
    assert kitchen.me.holding is None


def test_one_thing_is_laid_down():
    lay = parse_behaviour({"does": "lay", "counters": [[2, 3]]})
    kitchen = Watched(FORCED, ((1, 3), "south", "dish"), ((3, 1), "north"))
    assert kitchen.play(lay, 4) == [2, 5, 4, 4]
    assert kitchen.state.objects == {(2, 3): "dish"}


def test_a_helper_alone_serves_soup_after_soup():
    kitchen = Watched(ROOM, ((3, 1), "north"), ((1, 1), "north"))
    kitchen.play(parse_behaviour({"does": "helper"}), 110)
    assert did(kitchen, "soup_delivery") == 2


def test_a_helper_takes_what_lies_on_its_counters():
    helper = parse_behaviour({"does": "helper", "counters": [[2, 2], [3, 2]]})
    kitchen = Watched(CIRCUIT, ((3, 1), "north"), ((3, 3), "north"), {(3, 0): Soup((2, 0)), (3, 2): "onion"})
    assert kitchen.play(helper, 4) == [1, 5, 0, 5]
    kitchen = Watched(CIRCUIT, ((2, 1), "north"), ((3, 3), "north"), {(2, 2): READY})
    kitchen.play(helper, 12)
    assert did(kitchen, "soup_delivery") == 1


def test_two_helpers_hand_over_what_the_other_needs():
    helper = parse_behaviour({"does": "helper", "counters": SHARED, "insist": True})
    kitchen = Watched(FORCED, ((1, 2), "north"), ((3, 1), "north"))
    for _ in range(150):
        state = kitchen.state
        joint = [helper.act(kitchen.kitchens.layout, state, seat, 0) for seat in range(2)]
        kitchen.events += kitchen.kitchens.step([joint]).events[0]
    assert kitchen.events[0, EVENTS.index("soup_delivery")] >= 1


def test_cells_are_paced_in_turn():
    kitchen = Watched(RING, ((1, 1), "north"), ((3, 3), "north"))
    pace = parse_behaviour({"does": "pace", "cells": [[2, 1], [1, 1]], "every": 2})
    kitchen.play(pace, 2)
    assert kitchen.me.position == (2, 1)
    kitchen.play(pace, 2)
    assert kitchen.me.position == (1, 1)
    assert [pace.phase(t) for t in range(6)] == [0, 1, 2, 3, 0, 1]


def test_a_cell_is_gone_to():
    kitchen = Watched(RING, ((1, 1), "north"), ((3, 3), "north"))
    assert kitchen.play(parse_behaviour({"does": "goto", "cell": [3, 2]}), 5) == [2, 2, 1, 4, 4]
