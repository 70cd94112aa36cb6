"""Which methods the data separate, and the letters that say so."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.baselines.rows.separated import Pair, difference, fewest_seeds, letters, pairs
from overcooked_bench.estimate import Estimate, welch_interval
from overcooked_bench.evaluation.comparing.permutation import holm, over_seeds
from tests.baselines.rows.made import entry

NAMES = "abcdef"


def test_methods_that_differ_have_no_letter_in_common():
    entries = [entry("high", 0.6), entry("near", 0.595), entry("low", 0.3), entry("few", 0.2, seeds=3)]
    compared = pairs(entries)
    assert {(one.first, one.second) for one in compared if one.separated} == {("high", "low"), ("near", "low")}
    assert letters(entries, compared) == {"high": "a", "near": "a", "low": "b"}


def test_a_pair_is_tested_over_equal_numbers_of_seeds_and_adjusted_for_all_pairs():
    ten, five = entry("ten", 0.5), entry("five", 0.4, seeds=5)
    (pair,) = pairs([ten, five])
    assert pair.seeds == 5
    assert pair.difference == welch_interval(ten.by_seed[:5], five.by_seed)
    assert pair.p == pair.adjusted == over_seeds(ten.by_seed[:5], five.by_seed)
    compared = pairs([ten, five, entry("more", 0.45)])
    assert [one.adjusted for one in compared] == holm([one.p for one in compared])


def test_five_seeds_of_each_cannot_separate_two_among_many_pairs():
    assert fewest_seeds(1) == 4
    assert fewest_seeds(55) == 7
    entries = [entry(f"{level}", level, seeds=5, spread=0.001) for level in (0.9, 0.8, 0.7, 0.6, 0.5)]
    assert not any(one.separated for one in pairs(entries))
    assert {*letters(entries, pairs(entries)).values()} == {"a"}


def test_entries_without_an_overall_number_or_with_few_seeds_are_in_no_group():
    entries = [entry("whole", 0.5), entry("part", 0.5, n=None, by_seed=()), entry("few", 0.5, seeds=4)]
    assert not pairs(entries)
    assert letters(entries, []) == {"whole": "a"}


def test_the_difference_of_two_entries_is_over_all_or_one_layout():
    mine, other = entry("mine", 0.6), entry("other", 0.5, seeds=5)
    found = difference(mine, other, "coordination_ring")
    assert found is not None
    values = mine.layouts[1].by_seed[:5], other.layouts[1].by_seed
    assert found == (welch_interval(*values), over_seeds(*values))
    assert difference(mine, other) != found
    assert difference(mine, other, "bottleneck") is None


@given(st.sets(st.tuples(st.sampled_from(NAMES), st.sampled_from(NAMES)).filter(lambda pair: pair[0] < pair[1])))
def test_two_methods_share_a_letter_exactly_if_they_are_not_separated(apart):
    entries = [entry(name, 0.9 - 0.1 * index, seeds=5) for index, name in enumerate(NAMES)]
    compared = [Pair(one, other, 5, Estimate(0.1), 1.0, 0.0, 0.0) for one, other in sorted(apart)]
    found = {name: set(marks.split()) for name, marks in letters(entries, compared).items()}
    for index, one in enumerate(NAMES):
        for other in NAMES[index + 1 :]:
            assert bool(found[one] & found[other]) == ((one, other) not in apart)


@pytest.mark.parametrize("count", [1, 6, 55])
def test_with_the_fewest_seeds_one_pair_can_be_separated(count):
    seeds = fewest_seeds(count)
    high, low = (entry(name, level, seeds, spread=0.001) for name, level in (("high", 0.9), ("low", 0.1)))
    assert over_seeds(high.by_seed, low.by_seed) * count <= 0.05
