import pytest

from overcooked_bench.kitchen.codes import EAST, WEST
from overcooked_bench.scenarios.judge import judge
from overcooked_bench.scenarios.solving.oracle import play_honestly
from tests.scenarios.writing import POT, YIELD, scenario

CORRIDOR = """\
id: T03-corridor
category: memory
layout: bottleneck
kitchen: |
  XXOXDXX
  X  X  X
  X  XB X
  X   A X
  XSXXPPX
A: {{facing: up}}
B: {{facing: down, holds: soup, does: carry, {manner}: true}}
before: {before}
accept: A.x >= 5
budget: {budget}
why: Who goes first is known from what B did before.
"""
PUSHED = "{A: [stay, stay, stay, left], B: [down, down, down, down]}"
GAVE_WAY = "{A: [stay, down, left, stay], B: [up, down, stay, down]}"

DROPS_OUT = {
    "A": "{facing: down}",
    "B": "{facing: up, holds: onion, does: carry, until: 1}",
    "pots": "{1: 2 onions}",
}
CASES = {
    "one who stands": (POT, {}),
    "one who insists": (YIELD, {}),
    "one who walks to and fro": (POT, {"B": "{facing: down, does: loop, actions: [up, down]}", "accept": "A.at(3, 2)"}),
    "one who stops in the middle": (POT, {**DROPS_OUT, "accept": "A.pot >= 1", "budget": "12"}),
    "one who goes later": (
        POT,
        {"B": "{facing: down, does: frozen, until: 5, then: [1, 2]}", "accept": "A.at(3, 2)", "budget": "12"},
    ),
}


@pytest.mark.parametrize(("text", "changes"), CASES.values(), ids=CASES)
def test_the_past_is_enough(text, changes):
    drawn = scenario(text, **changes)
    for seat in (0, 1):
        for mirrored in (False, True):
            situation = drawn.seated(seat, mirrored)
            play = play_honestly(situation, drawn.budget)
            assert play.passed
            run = judge(situation, drawn.budget, play.actions)
            assert (run.passed, run.reached) == (True, len(play.actions))


def test_the_future_is_unknown():
    ways = [
        scenario(B=f"{{facing: down, does: script, actions: [stay, stay, {word}]}}", accept="A.at(3, 2)", budget="9")
        for word in ("left", "up", "stay")
    ]
    plays = [play_honestly(way.seated(0), 9) for way in ways]
    assert len({play.actions[:3] for play in plays}) == 1
    assert [play.passed for play in plays[1:]] == [True, False]


def test_what_cannot_be_known_is_not_passed():
    drawn = scenario(accept="B.pot >= 1", B="{facing: down, does: frozen}", budget="9")
    play = play_honestly(drawn.seated(0), 9)
    assert (play.passed, len(play.actions)) == (False, 9)
    assert not play_honestly(scenario(accept="A.pot >= 1", never="A.pot >= 1", budget="9").seated(0), 9).passed


def test_what_was_seen_before_counts():
    """The kitchens are the same when A is asked; in one B has pushed, in the other it gave way when A looked at it."""
    pushes = scenario(CORRIDOR.format(manner="insist", budget=15, before=PUSHED))
    yields = scenario(CORRIDOR.format(manner="yields", budget=4, before=GAVE_WAY))
    starts, firsts = [], []
    for drawn in (pushes, yields):
        situation = drawn.seated(0)
        starts.append(judge(situation, 1, (4,)).states[-2])
        play = play_honestly(situation, drawn.budget)
        assert play.passed
        firsts.append(play.actions[0])
    assert starts[0] == starts[1]
    assert firsts == [WEST, EAST]
