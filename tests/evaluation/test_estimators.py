"""Intervals cover what they say, on the shapes that scores really have, where the textbook's do not."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.estimate import t_interval
from overcooked_bench.evaluation.estimators import (
    Figure,
    Group,
    count_variance,
    over_partners,
    over_repetitions,
    rounding_variance,
)

SELF_PLAY = (
    np.array(
        [
            [475, 476, 479, 523, 533, 545, 553, 556, 562, 569, 594, 594, 608, 614, 625, 635],
            [338, 619, 619, 626, 629, 631, 632, 636, 637, 638, 641, 644, 655, 656, 657, 679],
            [351, 381, 420, 451, 490, 509, 544, 546, 562, 581, 582, 584, 608, 617, 645, 670],
            [198, 250, 258, 265, 275, 279, 282, 283, 287, 290, 290, 319, 335, 342, 347, 358],
            [125, 170, 186, 228, 234, 244, 322, 382, 386, 390, 396, 401, 412, 423, 435, 464],
        ]
    )
    / 1000
)
"""N of the sixteen self-play runs of train-v1 with a candidate of pool v1 on each of five layouts, in ascending order.
On the second layout one run failed; on the last one there are two camps."""
CAMPS = np.concatenate([40 + np.linspace(-8, 8, 6), 93 + np.linspace(-8, 8, 10)])
"""Points of sixteen training runs in two camps."""
ONE_FAILED = np.array([208.0] + [445.0] * 15) + np.linspace(-8, 8, 16)
"""Points of sixteen training runs, one of which failed."""


def covers(figure, truth, lowest=-np.inf, highest=np.inf):
    _, low, high = figure.estimate(lowest, highest)
    return low <= truth <= high


def coverage(layouts, seeds, runs=1500):
    """How often t over seeds, averaged over layouts first, covers the mean of the population of runs."""
    rng, layouts = np.random.default_rng(seeds), np.atleast_2d(layouts)
    rows = np.arange(len(layouts))[:, None]
    drawn = (layouts[rows, rng.integers(0, 16, (len(layouts), seeds))].mean(axis=0) for _ in range(runs))
    return np.mean([covers(over_repetitions(values), layouts.mean()) for values in drawn])


def test_without_repairs_it_is_the_textbooks_interval():
    values = [1.0, 2.0, 4.0]
    assert tuple(over_repetitions(values).estimate()) == pytest.approx(tuple(t_interval(values)))
    assert over_repetitions([3.0]) == Figure(3.0)
    assert Figure(0.9, 0.1, 4).estimate(0, 1).high == 1


@pytest.mark.parametrize("seeds", [3, 5, 10])
def test_n_over_five_layouts_covers_with_two_camps_of_seeds(seeds):
    assert 0.92 <= coverage(SELF_PLAY, seeds) <= 0.98
    wider = np.vstack([SELF_PLAY[:4], CAMPS / 166])  # the median range from floor to ceiling
    assert 0.92 <= coverage(wider, seeds, runs=4000) <= 0.98


@pytest.mark.parametrize(("seeds", "most"), [(3, 0.9), (5, 0.75), (10, 0.6)])
def test_no_interval_sees_a_failure_that_is_not_among_its_seeds(seeds, most):
    """The mean of runs of which one in sixteen fails: most samples have none, and their interval is narrow."""
    assert coverage(ONE_FAILED, seeds) < most
    assert coverage(SELF_PLAY[1], seeds) < most


def test_a_single_layout_with_two_camps_needs_more_than_three_seeds():
    assert coverage(CAMPS, 3) < 0.9
    assert coverage(CAMPS, 10) > 0.92


@pytest.mark.parametrize("partners", [7, 32])
@pytest.mark.parametrize("seeds", [3, 5, 10])
def test_counts_cover_although_all_seeds_agree(seeds, partners):
    """Most seeds are on the same side of a threshold with most partners: plain t has a width of 0."""
    rng, shares, plain, repaired = np.random.default_rng(1), np.full(partners, 1 / partners), [], []
    for _ in range(400):
        partner, sd = rng.normal(100, 40, partners), 4.0
        truth = np.mean(partner[:, None] + rng.normal(0, sd, (partners, 2000)) >= 60)
        reached = partner + rng.normal(0, sd, (seeds, partners)) >= 60
        values = reached.mean(axis=1)
        plain.append(covers(over_repetitions(values), truth, 0, 1))
        repaired.append(covers(over_repetitions(values, count_variance(reached, shares)), truth, 0, 1))
    assert np.mean(repaired) >= 0.95
    assert np.mean(plain) < 0.92


@given(st.integers(1, 20), st.integers(1, 8))
def test_the_least_variance_of_a_count_falls_with_seeds_that_agree(seeds, partners):
    shares = np.full(partners, 1 / partners)
    agree = count_variance(np.ones((seeds, partners)), shares)
    chance = (seeds + 0.5) / (seeds + 1)
    assert agree == pytest.approx(chance * (1 - chance) / partners)
    assert agree > count_variance(np.ones((seeds + 1, partners)), shares) > 0
    assert count_variance(np.zeros((seeds, partners)), shares) == pytest.approx(agree)


def test_a_partners_interval_covers_although_returns_are_whole_soups():
    rng, plain, repaired = np.random.default_rng(2), [], []
    for _ in range(600):
        middle, sd = rng.uniform(60, 200), rng.choice([1.0, 3.0, 5.0, 12.0])
        soups = 20 * np.floor(rng.normal(middle, sd, (10, 2)) / 20)
        truth = np.mean(20 * np.floor(rng.normal(middle, sd, 4000) / 20))
        blocks = soups.mean(axis=1)
        plain.append(covers(over_repetitions(blocks), truth))
        repaired.append(covers(over_repetitions(blocks, added=rounding_variance(20, seats=2)), truth))
    assert rounding_variance(20, seats=2) == 20**2 / 24
    assert np.mean(repaired) >= 0.95
    assert np.mean(plain) < 0.88


def covers_of_one_run(sizes, spread, runs=600):
    """How often the interval over partners covers the mean of all partners and starts, and t over episode blocks."""
    rng, strata = np.random.default_rng(3), np.repeat(list("abcd"), sizes)
    level, hits, blocks = np.repeat([0.9, 0.6, 0.4, 0.7], sizes), [], []
    for _ in range(runs):
        groups, of_blocks = [], np.zeros(20)
        for _ in range(5):
            weights = np.concatenate([one / one.sum() / 20 for one in (rng.uniform(0.5, 1.5, n) for n in sizes)])
            partner = level + rng.normal(0, spread, len(level))
            episodes = partner[:, None] + rng.normal(0, 0.3, (len(level), 20))
            groups.append(Group(episodes.mean(axis=1), weights, strata))
            of_blocks += weights @ episodes
        hits.append(covers(over_partners(groups), 0.65))
        blocks.append(covers(over_repetitions(of_blocks), 0.65))
    return np.mean(hits), np.mean(blocks)


@pytest.mark.parametrize("sizes", [(14, 8, 5, 5), (2, 2, 2, 2)], ids=["v1", "v1-lite"])
def test_the_interval_of_one_training_run_covers_over_partners_and_starts(sizes):
    """Episode blocks say nothing about other partners, and would do where partners do not differ."""
    over, blocks = covers_of_one_run(sizes, spread=0.25)
    assert 0.92 <= over <= 0.98
    assert blocks < 0.5
    over, blocks = covers_of_one_run(sizes, spread=0.0)
    assert 0.92 <= over <= 0.98
    assert 0.92 <= blocks <= 0.98


def test_strata_are_kept_apart_where_they_have_two_partners():
    values, shares = np.array([1.0, 1.0, 0.0, 0.0]), np.full(4, 0.25)
    assert over_partners([Group(values, shares, list("aabb"))])[:2] == (0.5, 0.0)
    assert over_partners([Group(values, shares, list("aaab"))]).error == pytest.approx((1 / 12) ** 0.5)
    assert over_partners([Group(values[:1], np.ones(1), ["a"])]) == Figure(1.0)
    assert over_partners([Group(values, shares, list("aabb"))], least=0.01).error == pytest.approx(0.1)
