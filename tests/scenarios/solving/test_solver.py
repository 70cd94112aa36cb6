"""The solver against brute force, the judge and the rules of scenarios."""

from itertools import product

import numpy as np
import pytest

from overcooked_bench import Kitchens
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.judge import judge
from overcooked_bench.scenarios.solving.search import TooManyStates
from overcooked_bench.scenarios.solving.solver import search_for, solve
from tests.scenarios.writing import POT, YIELD, scenario

STEPS = 4
FROM_ONE_STEP = {
    "a pot": {},
    "what is held": {"A": "{facing: left}", "accept": "A.holds(onion) and A.y == 1"},
    "an event of the partner": {
        "B": "{facing: right, holds: soup, does: carry, insist: true}",
        "accept": "B.serve >= 1",
    },
    "both": {"B": "{facing: right, holds: soup, does: carry}", "accept": "B.serve >= 1 and A.pot >= 1"},
    "a choice": {"accept": "A.at(3, 1) or A.drop >= 1"},
    "a place that is taken": {"accept": "A.at(3, 2)"},
    "a place that is left": {"B": "{facing: right, does: loop, actions: [up, down]}", "accept": "A.at(3, 2)"},
    "being in the way": {"B": "{facing: down, does: loop, actions: [up, left]}", "accept": "blocked(B) >= 2"},
    "something to avoid": {"accept": "A.pot >= 1", "never": "A.y == 1"},
    "a counter": {"accept": "counter(0, 2) == onion"},
}


def brute_force(situation, steps):
    """The fewest steps of any of the 6 ^ steps plans that passes, judged in kitchens of their own; None for none."""
    plans = list(product(range(6), repeat=steps))
    kitchens = Kitchens(situation.layout, len(plans), horizon=1000, actions_taken=True)
    for row in range(len(plans)):
        kitchens.set_state(row, situation.state)
    search = search_for(situation)
    counts, alive = np.zeros((len(plans), len(situation.counters)), np.uint16), np.ones(len(plans), np.bool_)
    for t in range(steps + 1):
        reached, lost = search.judge(kitchens.batch.rows, counts)
        if (reached & alive).any():
            return t
        if t == steps:
            return None
        alive &= ~lost
        joint, before = np.empty((len(plans), 2), np.int64), kitchens.batch.rows.copy()
        joint[:, situation.seat] = [plan[t] for plan in plans]
        known = {}
        for row, now in enumerate(before):
            key = now.tobytes()
            if key not in known:
                known[key] = situation.behaviour.act(situation.layout, kitchens.state(row), situation.partner_seat, t)
            joint[row, situation.partner_seat] = known[key]
        taken = kitchens.step(joint).actions_taken
        counts = search.count(kitchens.batch.rows, taken, counts)


@pytest.mark.parametrize("changes", FROM_ONE_STEP.values(), ids=FROM_ONE_STEP)
def test_no_plan_is_shorter_than_the_solution(changes):
    drawn = scenario(POT, **changes)
    for seat in (0, 1):
        situation = drawn.seated(seat)
        found = solve(situation, STEPS)
        assert (found and found.steps) == brute_force(situation, STEPS)


@pytest.mark.parametrize(
    ("text", "changes"), [(YIELD, {}), (YIELD, {"accept": "B.pot >= 1 and A.holds(onion)"}), (POT, {})], ids=str
)
def test_a_solution_passes_in_the_shipped_kitchen_from_everywhere(text, changes):
    drawn = scenario(text, budget="30", **changes)
    steps = set()
    for seat in (0, 1):
        for mirrored in (False, True):
            situation = drawn.seated(seat, mirrored)
            found = solve(situation)
            assert found.steps == len(found.actions)
            run = judge(situation, found.steps, found.actions)
            assert (run.passed, run.reached) == (True, found.steps)
            steps.add(found.steps)
    assert len(steps) == 1


def test_there_may_be_no_solution():
    assert solve(scenario(never="A.pot >= 1").seated(0), 6) is None
    # No state is new after a while, however many steps there are.
    assert (
        solve(scenario(accept="A.at(3, 2)", never="A.drop >= 1 or A.pot >= 1 or A.pick >= 1").seated(0), 10**6) is None
    )


def test_what_holds_at_once_takes_no_step():
    assert solve(scenario(accept="A.holds(onion)").seated(0)) == (0, ())
    assert solve(scenario(accept="A.pot >= 1", never="A.holds(onion)").seated(0)) is None


def test_what_was_played_before_counts_for_nothing_but_the_state():
    before = "{A: [interact, left], B: [stay, stay]}"
    drawn = scenario(before=before, budget="20")
    for seat in (0, 1):
        found = solve(drawn.seated(seat))
        assert found.steps == 4  # the next onion: it looks to the left already, though not at the pot
        assert judge(drawn.seated(seat), 4, found.actions).passed


def test_the_limit_is_the_budget():
    assert solve(scenario(YIELD, budget="6").seated(0)) is None
    assert solve(scenario(YIELD, budget="7").seated(0)).steps == 7


def test_a_search_that_grows_too_large_is_given_up(monkeypatch):
    situation = scenario(YIELD).seated(0)
    search = search_for(situation)
    start = search.row(situation.state), search.no_counts()
    with pytest.raises(TooManyStates, match=r"no solution found within \d steps and \d+ states"):
        search.run(*start, situation.behaviour, 0, 7, most=10)
    monkeypatch.setattr("overcooked_bench.scenarios.solving.solver.MOST_STATES", 10)
    with pytest.raises(ScenarioError, match=r"T01-yield-seat0: no solution found .* give a smaller budget"):
        solve(situation)


def test_a_tidy_search_puts_nothing_down():
    situation = scenario(accept="A.pick >= 1", never="A.pot >= 1", budget="9").seated(0)
    search = search_for(situation)
    start = search.row(situation.state), search.no_counts()
    assert search.run(*start, situation.behaviour, 0, 9, clutter=1) == search.run(*start, situation.behaviour, 0, 9)
    assert search.run(*start, situation.behaviour, 0, 9) is not None
    assert search.run(*start, situation.behaviour, 0, 9, clutter=0) is None
