"""Permutation tests keep their level, and one over partners instead of training seeds does not."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench.evaluation.comparing import permutation
from overcooked_bench.evaluation.comparing.permutation import holm, improvement, over_seeds, over_units, smallest_p

SCORES = st.lists(st.integers(-50, 50), min_size=3, max_size=3)


@pytest.mark.parametrize(("seeds", "least"), [(2, 2 / 6), (3, 2 / 20), (4, 2 / 70), (5, 2 / 252), (9, 2 / 48_620)])
def test_the_smallest_p_needs_four_seeds_to_be_significant(seeds, least):
    worse = np.arange(seeds)
    assert over_seeds(worse + 100, worse) == smallest_p(seeds) == pytest.approx(least)
    assert (least <= 0.05) == (seeds >= 4)


def test_a_p_worked_by_hand():
    # Six choices of two of 1, 2, 3, 5 have the sums 3, 4, 6, 5, 7, 8; four are 1.5 from 5.5 or more, as 1 + 3.
    assert over_seeds([1, 3], [2, 5]) == pytest.approx(4 / 6)
    assert over_units([3, -1, 2]) == pytest.approx(4 / 8)  # |sum| of 4 or more: +-(3 + 1 + 2), +-(3 - 1 + 2)


@settings(max_examples=30)
@given(SCORES, SCORES, st.permutations(range(3)))
def test_neither_order_nor_direction_matter(first, second, order):
    p = over_seeds(first, second)
    assert over_seeds(second, first) == p
    assert over_seeds(np.array(first)[list(order)] + 7, np.array(second) + 7) == p
    assert 0.1 <= p <= 1
    assert improvement(first, second) + improvement(second, first) == pytest.approx(1)


def test_drawn_relabellings_agree_with_all_of_them(monkeypatch):
    rng = np.random.default_rng(0)
    first, second, parts = rng.normal(1, 1, 8), rng.normal(0, 1, 8), rng.normal(0.5, 1, 12)
    exact = over_seeds(first, second), over_units(parts)
    monkeypatch.setattr(permutation, "MOST_EXACT", 0)
    assert (over_seeds(first, second), over_units(parts)) == pytest.approx(exact, abs=0.015)


def test_unequal_numbers_of_seeds_are_refused():
    with pytest.raises(ValueError, match="5 training seeds and 3"):
        over_seeds(range(5), range(3))


def camps(rng, size):
    """Seeds of two kinds, as real methods have them: 6 of 16 near 40 points, 10 near 93."""
    return np.where(rng.random(size) < 6 / 16, 40, 93) + rng.normal(0, 5, size)


SHAPES = {
    "normal": lambda rng: rng.normal(0, 1, (2, 5)),
    "two camps": lambda rng: camps(rng, (2, 5)),
    "a failing run": lambda rng: np.where(rng.random((2, 5)) < 1 / 16, 208, 445) + rng.normal(0, 20, (2, 5)),
    "other spread": lambda rng: rng.normal(0, [[1], [3]], (2, 5)),
}


@pytest.mark.parametrize("shape", SHAPES)
def test_two_methods_that_do_not_differ_are_seldom_called_different(shape):
    """The level, .048 at 5 seeds (12 of 252); methods of unequal spread, which it is not exact for, have up to .07."""
    rng = np.random.default_rng(1)
    rejected = np.mean([over_seeds(*SHAPES[shape](rng)) <= 0.05 for _ in range(1500)])
    assert rejected < (0.085 if shape == "other spread" else 0.066)


def test_flipping_partners_calls_methods_different_that_do_not_differ():
    """What seeds are relabelled for: a run's luck is common to its partners, so these are no independent evidence."""
    rng, found = np.random.default_rng(2), []
    for _ in range(300):
        seeds = rng.normal(0, 6, (2, 5, 1)) + rng.normal(0, 14, (2, 5, 20))
        found.append(over_units(np.diff(seeds.mean(axis=1), axis=0)[0]) <= 0.05)
    assert np.mean(found) > 0.25


def test_two_agents_that_do_not_differ_are_seldom_called_different():
    """Partners of four strata, of unequal weights; differences are symmetric, or a few large and many small ones."""
    rng, found = np.random.default_rng(3), {"symmetric": [], "lopsided": []}
    for _ in range(200):
        shares = rng.dirichlet(np.full(40, 3.0))
        found["symmetric"].append(over_units(shares * rng.standard_t(3, 40)) <= 0.05)
        found["lopsided"].append(over_units(shares * (rng.exponential(1, 40) - 1)) <= 0.05)
    assert np.mean(found["symmetric"]) < 0.09
    assert np.mean(found["lopsided"]) < 0.1


def test_the_probability_of_improvement_counts_pairs_and_halves_ties():
    assert improvement([2, 3], [1, 3]) == pytest.approx((1 + 0 + 1 + 0.5) / 4)


def test_holm_worked_by_hand():
    assert holm([0.01, 0.04, 0.03]) == pytest.approx([0.03, 0.06, 0.06])
    assert holm([0.5, 0.9]) == [1, 1]
    assert holm([0.02]) == [0.02]


@given(st.lists(st.sampled_from([0.001, 0.01, 0.02, 0.03, 0.2]), min_size=1, max_size=6))
def test_holm_rejects_what_the_step_down_procedure_rejects(p):
    rejected, ascending = set(), sorted(range(len(p)), key=lambda i: p[i])
    for rank, index in enumerate(ascending):
        if p[index] > 0.05 / (len(p) - rank):
            break
        rejected.add(index)
    assert {i for i, one in enumerate(holm(p)) if one <= 0.05 + 1e-12} == rejected


def test_every_relabelling_of_few_seeds_is_tried():
    """Against a plain count over all ways to split four scores."""
    scores = np.array([0.3, 1.2, 0.7, 2.5])
    sums = [sum(s * x for s, x in zip(signs, scores, strict=True)) for signs in product([-1, 1], repeat=4)]
    balanced = [total for total, signs in zip(sums, product([-1, 1], repeat=4), strict=True) if sum(signs) == 0]
    observed = abs(scores[:2].sum() - scores[2:].sum())
    share = np.mean([abs(one) >= observed - 1e-12 for one in balanced])
    assert over_seeds(scores[:2], scores[2:]) == pytest.approx(share)
