import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench.agents.mirror import mirror_actions, mirror_state
from overcooked_bench.scenarios.items import load_scenarios
from overcooked_bench.scenarios.judge import judge, replay
from overcooked_bench.scenarios.stage import Part, Stage
from tests.scenarios.writing import POT, YIELD, scenario

UP, DOWN, RIGHT, LEFT, STAY, INTERACT = range(6)
AWAY = (DOWN, DOWN, LEFT, LEFT, UP, LEFT, INTERACT)  # out of the way, round to the dishes, one in hand


@pytest.mark.parametrize("seat", [0, 1])
def test_what_is_reached_is_passed_at_that_step(seat):
    run = judge(scenario(YIELD).seated(seat), 15, AWAY)
    assert (run.passed, run.reached, run.spoiled) == (True, len(AWAY), None)
    assert run.why() == "passed at step 7 of 15"
    assert len(run.states) == len(run.actions) + 1 == len(AWAY) + 1
    assert [joint[seat] for joint in run.actions] == list(AWAY)


def test_the_mirror_turns_everything():
    turned = [{LEFT: RIGHT, RIGHT: LEFT}.get(action, action) for action in AWAY]
    situation = scenario(YIELD).seated(0, mirrored=True)
    assert judge(situation, 15, turned).reached == len(AWAY)
    assert not judge(situation, 15, AWAY).passed


@settings(max_examples=60, deadline=None)
@given(st.sampled_from(load_scenarios()), st.sampled_from([0, 1]), st.lists(st.integers(0, 5), max_size=25))
def test_whatever_is_done_the_mirror_turns_it(read, seat, own):
    plain = judge(read.seated(seat), 30, own)
    turned = judge(read.seated(seat, mirrored=True), 30, mirror_actions(own).tolist())
    assert (turned.passed, turned.reached, turned.spoiled) == (plain.passed, plain.reached, plain.spoiled)
    assert turned.states == tuple(mirror_state(state, read.layout.width) for state in plain.states)
    assert [truth.first for truth in turned.accept] == [truth.first for truth in plain.accept]


def test_the_budget_ends_a_run():
    situation = scenario(YIELD).seated(0)
    assert judge(situation, 7, AWAY).passed
    run = judge(situation, 6, AWAY)
    assert not run.passed
    assert len(run.actions) == 6


def test_a_failure_says_which_part_was_missing():
    run = judge(scenario(YIELD).seated(0), 15, AWAY[:5])
    assert "`B.pot >= 1` held at step" in run.why()
    assert "`A.holds(dish)` never held" in run.why()


def test_what_held_and_holds_no_more_is_told():
    read = scenario(accept="A.holds(onion) and A.pot >= 1")
    run = judge(read.seated(0), 3, [INTERACT])
    assert [str(truth) for truth in run.accept] == [
        "`A.holds(onion)` held at step 0, and no more at the end",
        "`A.pot >= 1` held at step 1",
    ]


def test_alternatives_are_told_one_by_one():
    run = judge(scenario(accept="[A.serve >= 1, B.pot >= 1 and B.holds(dish)]").seated(0), 2, [])
    assert [truth.text for truth in run.accept] == ["A.serve >= 1", "B.pot >= 1 and B.holds(dish)"]


def test_what_must_never_be_ends_a_run():
    read = scenario(never="A.holds(nothing)", accept="A.pick >= 1")
    run = judge(read.seated(0), 3, [INTERACT])
    assert (run.passed, run.spoiled, len(run.actions)) == (False, 1, 1)
    assert run.why() == "`A.holds(nothing)` (never) held at step 1"


def test_what_is_reached_and_forbidden_at_once_fails():
    assert not judge(scenario(never="pot(1).n > 0").seated(0), 3, [INTERACT]).passed
    assert judge(scenario(never="pot(1).n > 1").seated(0), 3, [INTERACT]).passed


def test_what_happens_before_is_not_counted_and_not_asked():
    read = scenario(before="{A: [interact, left], B: [stay, up]}", accept="A.pot >= 1 or B.y == 2")
    run = judge(read.seated(1), 3, [])
    assert not run.passed
    assert run.actions[:2] == ((STAY, INTERACT), (UP, LEFT))
    assert len(run.actions) == 2 + 3
    assert run.states[2].chefs[0].position == (3, 1)
    assert judge(scenario(before="{B: [up]}", accept="B.y == 1").seated(0), 3, []).reached == 0


def test_the_partners_clock_starts_after_what_happens_before():
    read = scenario(B="{facing: down, does: script, actions: [up]}", before="{A: [stay, stay]}")
    run = judge(read.seated(0), 3, [])
    assert [joint[1] for joint in run.actions] == [STAY, STAY, UP, STAY, STAY]


def test_only_the_end_of_the_horizon_is_near_its_end():
    late, early = scenario(category="horizon", before="{A: [up]}"), scenario(before="{A: [up]}")
    assert [judge(read.seated(0), 3, [STAY]).states[0].timestep for read in (late, early)] == [396, 0]
    run = judge(late.seated(0), 3, [STAY, STAY, INTERACT])
    assert (run.passed, run.states[-1].timestep) == (True, 400)


def test_runs_of_different_lengths_share_a_stage():
    short = Part(scenario(category="horizon").seated(0), 2)
    long = Part(scenario(before="{A: [stay]}", accept="A.serve >= 1").seated(1, False), 6)
    stage = Stage([short, long], repeats=2)
    for step in range(7):
        assert not stage.over
        stage.play(np.array([INTERACT if step else STAY, STAY, INTERACT, INTERACT]))
    assert stage.over
    assert stage.passed.tolist() == [True, False, False, False]
    assert stage.reached.tolist() == [2, -1, -1, -1]
    assert stage.actions.shape == (7, 4, 2)


def test_a_run_is_judged_again_from_its_joint_actions():
    situation = scenario(YIELD, before="{A: [stay], B: [stay]}").seated(1)
    run = judge(situation, 15, AWAY)
    assert run.passed
    assert replay(situation, 15, run.actions) == run


def test_the_film_shows_the_last_steps():
    run = judge(scenario(POT).seated(0), 3, [LEFT, UP])
    film = run.film(2)
    assert film.splitlines()[:5] == [
        f"{'step 1':18}{'step 2':18}step 3",
        f"{'A up':18}A stays",
        f"{'B stays':18}B stays",
        "   ".join(["######[_]######"] * 3),
        "<O>A<o      <O>   <O>A^o      <O>   <O>A^o      <O>",
    ]
    assert "step 0" in run.film()
    assert "\x1b" in run.film(colour=True)
    assert len(run.film(2, width=40).splitlines()) == 2 * (3 + 4) + 1
    assert "B>o" in judge(scenario(YIELD).seated(1), 15, []).film(1)
