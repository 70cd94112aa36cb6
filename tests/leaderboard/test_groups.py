"""What the data separate in a table: letters of few methods, places of many."""

from pathlib import Path

import msgspec
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.scores import read_scores
from overcooked_bench.leaderboard.site.board import parts_of
from overcooked_bench.leaderboard.site.groups import MOST_LETTERS, separate, separate_agents


def methods(count, seeds=5, apart=0.1, spread=0.002):
    draws = np.random.default_rng(0)
    return {f"m{index}": tuple(draws.normal(1 - apart * index, spread, seeds)) for index in range(count)}


def test_few_methods_have_letters_and_their_exact_places():
    found = separate(methods(3))
    assert found.permuted
    assert {name: (mark.letters, mark.places) for name, mark in found.marks.items()} == {
        "m0": ("a", "1"),
        "m1": ("b", "2"),
        "m2": ("c", "3"),
    }


def test_many_methods_are_separated_by_t_and_have_places_only():
    found = separate(methods(MOST_LETTERS + 1))
    assert not found.permuted
    assert found.separated == found.pairs == 78
    assert {mark.letters for mark in found.marks.values()} == {""}
    assert [mark.places for mark in found.marks.values()] == [str(place) for place in range(1, 14)]


def test_one_method_of_many_seeds_does_not_leave_the_others_inseparable():
    runs = {**methods(5), "longer": tuple(np.random.default_rng(1).normal(-1, 0.002, 10))}
    found = separate(runs)
    assert not found.permuted
    assert found.separated == found.pairs == 15


def test_seeds_that_agree_by_luck_separate_no_method_from_its_neighbours():
    runs = methods(20, apart=0, spread=0.05)
    level = float(np.mean([np.mean(one) for one in runs.values()]))
    runs["lucky"] = (level + 0.01,) * 5
    assert separate(runs).marks["lucky"].places == "1-21"


def test_scores_without_any_spread_can_be_tested():
    runs = {f"m{index}": (0.5,) * 5 for index in range(9)}
    assert separate(runs).separated == 0
    assert separate({"better": (0.6,) * 5, **runs}).separated == 9
    assert separate_agents({name: dict.fromkeys(range(20), 0.025) for name in agents(40)}).separated == 0


def test_one_method_or_none_has_no_pair():
    assert separate({}).pairs == 0
    assert separate(methods(1)).marks["m0"].places == "1"


@given(st.integers(2, 16), st.integers(2, 6), st.floats(0, 0.2), st.integers(0, 9))
def test_places_hold_the_place_itself_and_agree_with_the_letters(count, seeds, apart, number):
    draws = np.random.default_rng(number)
    runs = {f"m{index}": tuple(draws.normal(-apart * index, 0.05, seeds)) for index in range(count)}
    runs = dict(sorted(runs.items(), key=lambda pair: -np.mean(pair[1])))
    found = separate(runs)
    for place, mark in enumerate(found.marks.values(), start=1):
        assert 1 <= mark.first <= place <= mark.last <= count
    unseparated = sum(mark.last - mark.first for mark in found.marks.values()) // 2
    assert found.separated == found.pairs - unseparated


def agents(count, partners=40, apart=0.1):
    draws = np.random.default_rng(0)
    hard = draws.normal(0, 1, partners)  # what partners are like is common to all agents
    return {
        f"m{index}": {i: (one - apart * index + 0.01 * draws.normal()) / partners for i, one in enumerate(hard)}
        for index in range(count)
    }


@pytest.mark.parametrize(("count", "permuted"), [(4, True), (40, False)])
def test_agents_are_paired_over_their_partners(count, permuted):
    found = separate_agents(agents(count))
    assert found.permuted == permuted
    assert found.separated == found.pairs
    assert [mark.places for mark in found.marks.values()] == [str(place) for place in range(1, count + 1)]


@pytest.mark.parametrize("count", [4, 40])
def test_equal_agents_are_not_separated(count):
    assert separate_agents(agents(count, apart=0)).separated == 0


def test_an_agent_that_met_others_has_no_place():
    some = agents(3)
    some["m1"] = {**some["m1"], "another": 0.1}
    assert list(separate_agents(some).marks) == ["m0", "m2"]
    assert separate_agents({}).marks == {}


def test_the_parts_of_an_agent_sum_to_its_score():
    row = Path(__file__).parents[2] / "baselines" / "board" / "greedy"
    scores = read_scores(row)
    found = parts_of(scores)
    assert len(found) == 160
    assert sum(found.values()) == pytest.approx(scores.overall.value)
    assert parts_of(msgspec.structs.replace(scores, overall=Estimate(0.5))) == {}
    assert parts_of(msgspec.structs.replace(scores, training_seeds=5)) == {}
