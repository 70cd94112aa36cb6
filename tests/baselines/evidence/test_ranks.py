"""Rank correlations, and their intervals over families."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import spearmanr

from overcooked_bench.baselines.evidence.ranks import Ranked, correlation, spearman

SCORES = st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6), st.integers(1, 3)), min_size=3, max_size=12)


@given(SCORES)
def test_it_is_scipys_correlation_of_entrants_repeated_as_often_as_they_were_drawn(rows):
    first, second, count = np.array(rows).T
    found = spearman(first, second, [count])[0]
    if len(set(first)) == 1 or len(set(second)) == 1:
        assert np.isnan(found)
    else:
        assert found == pytest.approx(spearmanr(np.repeat(first, count), np.repeat(second, count))[0], abs=1e-9)


def test_it_is_one_where_the_order_is_the_same_and_minus_one_where_it_is_reversed():
    families = ["a", "a", "b", "b", "c", "d", "e"]
    rising = np.arange(7.0)
    same = correlation([Ranked(families, rising, rising**3)]).rho
    assert (same.value, same.low > 0.9, same.high) == (pytest.approx(1), True, pytest.approx(1, abs=1e-2))
    assert correlation([Ranked(families, rising, -rising)]).rho.value == pytest.approx(-1)


def test_pooled_it_is_the_mean_over_layouts_by_their_entrants():
    rising = np.arange(6.0)
    found = correlation([Ranked("abcabc", rising, rising), Ranked("abc", rising[:3], -rising[:3])])
    assert found.rho.value == pytest.approx((6 - 3) / 9)
    assert (found.entrants, found.families) == (9, 3)


def test_without_enough_entrants_or_families_less_is_said():
    rising = np.arange(4.0)
    assert correlation([Ranked("abcd", rising, rising)]).rho.interval is None
    assert np.isnan(correlation([Ranked("ab", rising[:2], rising[:2])]).rho.value)
    assert np.isnan(correlation([Ranked([], rising[:0], rising[:0])]).rho.value)
    assert np.isnan(correlation([Ranked("abcd", rising, np.ones(4))]).rho.value)


def of_families(rng, count=10, size=4):
    """Families whose means agree strongly, with members that hardly do."""
    both = rng.standard_normal((2, count))
    both[1] = 0.8 * both[0] + 0.6 * both[1]
    first, second = np.repeat(both, size, axis=1) + 0.7 * rng.standard_normal((2, count * size))
    return [str(index) for index in np.repeat(np.arange(count), size)], first, second


def test_the_interval_covers_the_truth_about_as_often_as_it_says():
    rng = np.random.default_rng(1)
    truth = spearmanr(*of_families(rng, 5000)[1:])[0]
    found = [correlation([Ranked(*of_families(rng))]).rho for _ in range(100)]
    assert sum(rho.low <= truth <= rho.high for rho in found) >= 89
    one_each = [correlation([Ranked([str(i) for i in range(40)], *of_families(rng)[1:])]).rho for _ in range(100)]
    assert np.mean([r.high - r.low for r in found]) > 1.15 * np.mean([r.high - r.low for r in one_each])
