import pytest

from overcooked_bench.agents.behaviours.parsing import parse_behaviour
from overcooked_bench.kitchen.codes import EAST, NORTH, SOUTH, STAY, WEST
from overcooked_bench.kitchen.state import Soup
from tests.agents.behaviours.kitchens import Watched

RING, CORRIDOR = "coordination_ring", "bottleneck"
POT = {(3, 0): Soup((2, 0))}
ME, IN_THE_WAY = ((1, 1), "east", "onion"), ((2, 1), "north")


def test_who_insists_pushes_and_goes_on_once_the_way_is_clear():
    kitchen = Watched(RING, ME, IN_THE_WAY, POT)
    carry = parse_behaviour({"does": "carry", "insist": True})
    assert kitchen.play(carry, 4) == [EAST] * 4
    assert kitchen.me.position == (1, 1)
    kitchen.play(carry, 6, [EAST, EAST, SOUTH])
    assert kitchen.state.objects[3, 0].recipe == (3, 0)


def test_who_is_polite_goes_round_or_waits():
    kitchen = Watched(RING, ME, IN_THE_WAY, POT)
    carry = parse_behaviour({"does": "carry"})
    assert kitchen.play(carry, 1) == [SOUTH]
    kitchen.play(carry, 12)
    assert kitchen.state.objects[3, 0].recipe == (3, 0)
    waits = Watched(CORRIDOR, ((2, 3), "east", "onion"), ((3, 3), "north"), {(4, 4): Soup((2, 0))})
    assert waits.play(carry, 3) == [STAY] * 3
    waits.play(carry, 5, [EAST, NORTH])
    assert waits.state.objects[4, 4].recipe == (3, 0)


def test_who_yields_steps_aside_when_looked_at():
    carry = parse_behaviour({"does": "carry", "yields": True})
    kitchen = Watched(CORRIDOR, ((3, 3), "east", "onion"), ((4, 3), "west"), {(4, 4): Soup((2, 0))})
    assert kitchen.play(carry, 1) == [WEST]
    assert kitchen.me.position == (2, 3)
    not_asked = Watched(CORRIDOR, ((3, 3), "east", "onion"), ((4, 3), "east"), {(4, 4): Soup((2, 0))})
    assert not_asked.play(carry, 1) == [STAY]


@pytest.mark.parametrize("does", ["plater", "carry"])
def test_who_yields_does_so_without_anything_to_do(does):
    kitchen = Watched(RING, ((2, 1), "north"), ((1, 1), "east"))
    assert kitchen.play(parse_behaviour({"does": does, "yields": True}), 1) == [EAST]


def test_one_who_stands_in_a_dead_end_stays():
    kitchen = Watched("forced_coordination", ((1, 1), "south"), ((1, 2), "north"))
    assert kitchen.play(parse_behaviour({"does": "plater", "yields": True}), 2) == [STAY] * 2
