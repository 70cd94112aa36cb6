import pytest

from overcooked_bench.scenarios.solving.pairs import pair_faults
from tests.scenarios.writing import POT, edited, scenario

ASKS = """\
id: T06-moves
category: memory
layout: cramped_room
kitchen: |
  XXPXX
  O A O
  X B X
  XDXSX
A: {facing: down, holds: onion}
B: {facing: up, does: carry, yields: true}
before: {A: [down], B: [right]}
accept: A.at(2, 2)
budget: 2
why: B makes room.
"""


def memory(**changes):
    return scenario(ASKS, **changes)


def test_b_keeps_to_its_rule_before():
    first = pair_faults(memory(), memory(before="{A: [down], B: [left]}"))
    assert first[0] == "B of T06-moves does left at step 0 of `before`; its behaviour would do right"


FAULTY = {
    "no-before": ({"before": ""}, "has no `before`"),
    "clock": ({"B": "{facing: up, does: loop, actions: [left, stay]}"}, "goes by the clock"),
    "length": ({"before": "{A: [down, up, down], B: [right, stay, stay]}"}, "longer than the other"),
    "look": ({"A": "{facing: down, holds: dish}"}, "do not look the same"),
    "no-memory": ({}, "it takes no memory from seat 0"),
}


@pytest.mark.parametrize(("changes", "message"), FAULTY.values(), ids=FAULTY.keys())
def test_faults_of_memory_pairs(changes, message):
    assert any(message in fault for fault in pair_faults(memory(), memory(**changes)))


def cluttered(row, **changes):
    return scenario(edited(POT, budget="auto").replace("XDXSX", row), **changes)


def test_a_thing_that_does_not_matter():
    assert pair_faults(scenario(POT, budget="auto"), cluttered("XDoSX")) == []


def test_a_thing_that_matters():
    drops = {"accept": "A.drop(dish) >= 1", "A": "{facing: left, holds: dish}", "budget": "auto"}
    aside = POT.replace("O A O", "O   O")
    free, taken = (scenario(aside.replace("X  BX", f"{counter}A BX"), **drops) for counter in "Xo")
    assert [fault.partition(":")[0] for fault in pair_faults(free, taken)] == ["it does matter"] * 4


DIFFERENT = {
    "nothing": {},
    "chef": {"A": "{facing: left, holds: onion}"},
    "pots": {"pots": "{1: 1 onion}"},
    "partner": {"B": "{facing: down, does: carry}"},
    "goal": {"accept": "pot(1).n == 1"},
    "budget": {"budget": "4"},
}


@pytest.mark.parametrize("changes", DIFFERENT.values(), ids=DIFFERENT.keys())
def test_halves_differ_in_what_lies_about_alone(changes):
    one = scenario(POT) if not changes else cluttered("XDoSX")
    (fault,) = pair_faults(one, scenario(POT, **{"budget": "auto"} | changes))
    assert "differ in the objects on counters, and only there" in fault
