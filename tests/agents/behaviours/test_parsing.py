import pytest

from overcooked_bench.agents.behaviours.parsing import KINDS, behaviour_from_text, parse_actions, parse_behaviour

EXAMPLES = {
    "frozen": {},
    "script": {"actions": ["up"]},
    "loop": {"actions": ["left", "right"]},
    "pace": {"cells": [[1, 1], [2, 1]]},
    "goto": {"cell": [1, 1]},
    "receiver": {"counters": [[0, 2]]},
    "dumper": {"counters": [[0, 2]]},
    "lay": {"counters": [[0, 2]]},
}


@pytest.mark.parametrize("name", KINDS)
def test_every_kind_is_read_and_equal_to_itself(name):
    mapping = {"does": name, **EXAMPLES.get(name, {})}
    assert parse_behaviour(mapping) == parse_behaviour(mapping)
    assert hash(parse_behaviour(mapping)) == hash(parse_behaviour(mapping))


WRONG = {
    "no mapping": ("carry", r"write a mapping such as \{does: carry"),
    "no name": ({"insist": True}, r"write a mapping such as \{does: carry"),
    "an unknown name": ({"does": "carries"}, "did you mean 'carry'"),
    "a list for a name": ({"does": ["carry"]}, "is no behaviour"),
    "an unknown key": ({"does": "carry", "insists": True}, "did you mean 'insist'"),
    "a key of another": ({"does": "carry", "counters": [[1, 1]]}, "'carry' has no key 'counters'"),
    "a manner of one who does not walk": ({"does": "loop", "actions": ["up"], "insist": True}, "has no key 'insist'"),
    "a missing key": ({"does": "dumper"}, "'dumper' needs the key 'counters'"),
    "no truth": ({"does": "carry", "insist": "yes"}, "write true or false"),
    "two manners": ({"does": "carry", "insist": True, "yields": True}, "cannot both insist and yield"),
    "no actions": ({"does": "script", "actions": []}, r"write a list such as \[up"),
    "an unknown action": ({"does": "loop", "actions": ["upp"]}, "did you mean 'up'"),
    "a wrong number of times": ({"does": "loop", "actions": ["up*0"]}, "is no action"),
    "too many times": ({"does": "loop", "actions": ["up*1000"]}, "is no action"),
    "no cells": ({"does": "receiver", "counters": [2, 1]}, "is no cell"),
    "no list of cells": ({"does": "receiver", "counters": "all"}, "write a list of cells"),
    "a truth in a cell": ({"does": "goto", "cell": [True, 1]}, "is no cell"),
    "an item that is none": ({"does": "dumper", "counters": [[0, 2]], "item": "soup"}, "onion, tomato, dish"),
    "an item of another": ({"does": "onions", "item": "dish"}, "onion, tomato"),
    "no number of steps": ({"does": "carry", "until": -1}, "a whole number from 0"),
    "a fraction of steps": ({"does": "carry", "from": 1.5}, "a whole number from 0"),
    "an end before the start": ({"does": "carry", "from": 5, "until": 3}, "until: 3; give a whole number from 5"),
    "no step": ({"does": "pace", "cells": [[1, 1]], "every": 0}, "a whole number from 1"),
    "a step that never comes": ({"does": "carry", "from": 10**30}, "a whole number from 0 to 1,000,000,000"),
    "a seed that no generator takes": ({"does": "carry", "noisy": {"p": 0.1, "seed": 10**30}}, "seed: 1000.*; give"),
    "no noise": ({"does": "carry", "noisy": 0.1}, r"write \{p: 0.1, seed: 0\}"),
    "no probability": ({"does": "carry", "noisy": {"p": 2, "seed": 0}}, "give a probability"),
    "a fault further in": ({"does": "carry", "then": {"does": "pause"}}, "then: does: 'pause' is no behaviour"),
}


@pytest.mark.parametrize(("mapping", "message"), WRONG.values(), ids=WRONG.keys())
def test_what_is_wrong_is_said(mapping, message):
    with pytest.raises(ValueError, match=message):
        parse_behaviour(mapping)


def test_actions_have_two_sets_of_names():
    assert parse_actions(["up", "south", "right", "west", "stay*2", "interact"]) == (0, 1, 2, 3, 4, 4, 5)


def test_then_has_three_forms():
    forms = ["onions", {"does": "onions"}, {"does": "onions", "insist": False}]
    assert len({parse_behaviour({"does": "carry", "then": form}) for form in forms}) == 1
    there = parse_behaviour({"does": "carry", "insist": True, "then": [1, 1]})
    assert there == parse_behaviour({"does": "carry", "insist": True, "then": {"does": "goto", "cell": [1, 1]}})
    assert there.floor == {(1, 1)}


def test_a_line_of_text():
    assert behaviour_from_text("carry") == parse_behaviour({"does": "carry"})
    assert behaviour_from_text("{does: carry, insist: true}") == parse_behaviour({"does": "carry", "insist": True})
    with pytest.raises(ValueError, match="not YAML"):
        behaviour_from_text("{does: ")
