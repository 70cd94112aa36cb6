"""What the data separate in a table: letters of few methods, places of many."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.leaderboard.site.groups import MOST_LETTERS, separate


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


def test_seeds_that_agree_by_luck_separate_no_method_from_its_neighbours():
    runs = methods(20, apart=0, spread=0.05)
    level = float(np.mean([np.mean(one) for one in runs.values()]))
    runs["lucky"] = (level + 0.01,) * 5
    assert separate(runs).marks["lucky"].places == "1-21"


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
