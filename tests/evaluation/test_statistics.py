"""The numbers of the literature and of simulations, and laws that a wrong unit of analysis would break."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from overcooked_bench import estimate
from overcooked_bench.estimate import ratio_interval, t_interval, weighted_interval, welch_interval
from overcooked_bench.evaluation import statistics
from overcooked_bench.evaluation.statistics import (
    describe_low_quantile,
    detectable,
    low_quantile,
    lower_bound,
    ordered,
    seeds_needed,
    tail_mean,
    tail_quantile,
    threshold,
    upper_bound,
    weighted_tail,
)


def simulated_returns(
    rng, seeds, partners=20, episodes=20, sd_seed=6.0, sd_partner=40.0, sd_cell=14.0, sd_episode=25.0
):
    """Draws (S, P, E) returns with the variance components of a real benchmark, and the mean for these partners."""
    partner = rng.normal(100, 40, (1, partners, 1))
    returns = (
        partner
        + rng.normal(0, sd_seed, (seeds, 1, 1))
        + rng.normal(0, 14, (seeds, partners, 1))
        + rng.normal(0, 25, (seeds, partners, episodes))
    )
    return returns, float(partner.mean())


def test_the_t_interval_is_the_textbook_one():
    value, low, high = t_interval([1, 2, 3, 4])
    expected = stats.t.interval(0.95, 3, loc=2.5, scale=np.std([1, 2, 3, 4], ddof=1) / 2)
    assert value == 2.5
    assert (low, high) == pytest.approx(expected)


def test_one_value_gives_no_interval():
    assert tuple(t_interval([7])) == (7, None, None)


def test_an_interval_is_clipped_to_what_is_possible():
    assert t_interval([0, 0, 9], lowest=0).low == 0
    assert t_interval([5, 5, 4], highest=5).high == 5


@given(st.lists(st.floats(-100, 100), min_size=2, max_size=8), st.floats(0.1, 1000))
def test_a_ratio_over_units_of_one_size_is_the_mean_of_their_ratios(ratios, weight):
    found = ratio_interval(np.array(ratios) * weight, [weight] * len(ratios))
    assert tuple(found) == pytest.approx(tuple(t_interval(ratios)), abs=1e-9)


def test_a_ratio_counts_large_units_more_and_a_single_one_has_no_interval():
    assert ratio_interval([1, 30], [1, 10]).value == 31 / 11
    assert tuple(ratio_interval([6], [2])) == (3, None, None)
    assert tuple(ratio_interval([2, 20], [1, 10])) == (2, 2, 2)
    assert ratio_interval([0, 9], [1, 1], lowest=0).low == 0


def test_the_interval_of_a_ratio_covers_it():
    rng = np.random.default_rng(3)
    runs, covered = 600, 0
    for _ in range(runs):
        sizes = rng.uniform(0.5, 1.5, 15)
        _, low, high = ratio_interval(sizes * rng.normal(5, 1, 15), sizes)
        covered += low <= 5 <= high
    assert 0.92 <= covered / runs <= 0.98


@pytest.mark.parametrize(("seeds", "sd_seed"), [(3, 6.0), (5, 18.0)])
def test_the_interval_over_seeds_covers_and_pooling_episodes_does_not(seeds, sd_seed):
    rng = np.random.default_rng(1)
    runs, covered, pooled = 600, 0, 0
    for _ in range(runs):
        returns, truth = simulated_returns(rng, seeds, sd_seed=sd_seed)
        _, low, high = t_interval(returns.mean(axis=(1, 2)))
        covered += low <= truth <= high
        _, low, high = t_interval(returns.mean(axis=1).ravel())  # every seed's episodes as if they were runs
        pooled += low <= truth <= high
    assert 0.92 <= covered / runs <= 0.98
    assert pooled / runs < 0.5


def test_the_interval_over_episode_blocks_covers_what_this_run_would_score():
    rng = np.random.default_rng(2)
    runs, covered = 600, 0
    for _ in range(runs):
        cells = rng.normal(100, 40, (7, 1))
        _, low, high = t_interval((cells + rng.normal(0, 25, (7, 10))).mean(axis=0))
        covered += low <= cells.mean() <= high
    assert 0.92 <= covered / runs <= 0.98


def test_permuting_seeds_within_one_partner_changes_the_interval():
    returns, _ = simulated_returns(np.random.default_rng(3), seeds=5)
    permuted = returns.copy()
    permuted[:, 4] = permuted[[3, 0, 4, 1, 2], 4]
    before, after = (t_interval(values.mean(axis=(1, 2))) for values in (returns, permuted))
    assert before.value == pytest.approx(after.value)
    assert before.high - before.low != pytest.approx(after.high - after.low)


@pytest.mark.parametrize(("n", "m"), [(3, 5), (5, 5), (2, 7)])
def test_the_welch_interval_is_that_of_scipy(n, m):
    rng = np.random.default_rng(4)
    first, second = rng.normal(50, 10, n), rng.normal(40, 3, m)
    value, low, high = welch_interval(first, second)
    expected = stats.ttest_ind(first, second, equal_var=False).confidence_interval(0.95)
    assert value == pytest.approx(first.mean() - second.mean())
    assert (low, high) == pytest.approx((expected.low, expected.high))


def test_a_difference_of_single_values_has_no_interval():
    assert tuple(welch_interval([3], [1, 2])) == (1.5, None, None)
    assert tuple(welch_interval([3, 3], [1, 1])) == (2, 2, 2)


def test_a_weighted_sum_of_means_has_the_interval_of_its_parts():
    rng = np.random.default_rng(5)
    one = rng.normal(50, 10, 6)
    low, high = t_interval(one).interval
    assert tuple(weighted_interval([(1, one)])) == pytest.approx(tuple(t_interval(one)))
    assert tuple(weighted_interval([(-2, one)])) == pytest.approx((-2 * one.mean(), -2 * high, -2 * low))
    halves = weighted_interval([(0.5, one), (0.5, one + 7)])  # equal variances: 10 degrees of freedom
    half = stats.t.ppf(0.975, 10) * one.std(ddof=1) / 12**0.5
    assert tuple(halves) == pytest.approx((one.mean() + 3.5, one.mean() + 3.5 - half, one.mean() + 3.5 + half))
    assert weighted_interval([(1, one), (1, [3])]).interval is None
    covered = 0
    for _ in range(400):
        groups = [(1 / 5, rng.normal(0, 10, 3)) for _ in range(5)] + [(-1 / 5, rng.normal(0, 20, 16)) for _ in range(5)]
        low, high = weighted_interval(groups).interval
        covered += low <= 0 <= high
    assert covered > 0.92 * 400


@pytest.mark.parametrize(("seeds", "chance"), [(3, 0.39), (5, 0.56), (10, 0.80), (19, 0.954)])
def test_the_smallest_seed_lies_below_the_quantile_as_often_as_the_table_says(seeds, chance):
    assert 1 - 0.85**seeds == pytest.approx(chance, abs=0.005)
    bound = lower_bound(seeds)
    assert (bound is None) == (seeds < 19)
    if bound is not None:
        assert (bound.rank, bound.confidence) == (1, pytest.approx(chance, abs=0.0005))


def test_the_worst_part_counts_partners_by_their_shares():
    values, shares = [[0.9, 0.1, 0.5], [0.0, 0.3, 0.6]], [0.5, 0.25, 0.25]
    assert weighted_tail(values, shares, 1 / 3) == pytest.approx([(0.1 * 0.25 + 0.5 / 12) * 3, 0.0])
    assert weighted_tail(values, shares, 1.0) == pytest.approx(np.array(values) @ shares)
    assert weighted_tail(values, shares, 0.25) == pytest.approx([0.1, 0.0])


def test_what_training_seeds_buy():
    """With the spread of N over self-play runs: about 0.1 on a layout, 0.035 for the mean of five."""
    assert seeds_needed(0.10, 0.10) == 9
    assert detectable(0.035, 5) == pytest.approx(0.051, abs=0.001)
    assert detectable(0.10, 9) <= 0.10 < detectable(0.10, 8)
    assert seeds_needed(0.001, 1.0) is None
    rng = np.random.default_rng(6)
    halves = [
        (found.high - found.low) / 2 for found in (welch_interval(*rng.normal(0, 0.1, (2, 9))) for _ in range(400))
    ]
    assert np.mean(halves) == pytest.approx(detectable(0.1, 9), rel=0.05)


def test_no_lower_bound_below_nineteen_seeds():
    assert next(n for n in range(1, 40) if lower_bound(n) is not None) == 19


@pytest.mark.parametrize(
    ("seeds", "rank", "confidence"), [(3, 3, 0.997), (5, 3, 0.973), (10, 4, 0.950), (20, 7, 0.978)]
)
def test_upper_bounds_are_those_of_the_table(seeds, rank, confidence):
    bound = upper_bound(seeds)
    assert (bound.rank, bound.confidence) == (rank, pytest.approx(confidence, abs=0.0005))
    drawn = np.sort(np.random.default_rng(4).normal(size=(4000, seeds)), axis=1)[:, rank - 1]
    assert np.mean(drawn >= stats.norm.ppf(0.15)) == pytest.approx(confidence, abs=0.015)


@pytest.mark.parametrize(
    ("seeds", "weights"),
    [
        (3, {0: 0.7, 1: 0.3}),
        (5, {0: 0.4, 1: 0.6}),
        (10, {1: 0.65, 2: 0.35}),
        (30, {4: 0.65, 5: 0.35}),
    ],
)
def test_the_quantile_is_of_type_seven(seeds, weights):
    values = np.random.default_rng(5).permutation(np.arange(seeds) ** 2.0)
    ascending = np.sort(values)
    assert low_quantile(values) == pytest.approx(sum(weight * ascending[k] for k, weight in weights.items()))


@pytest.mark.parametrize(("seeds", "bias"), [(3, 0.44), (5, 0.28), (10, 0.16)])
def test_the_quantile_of_few_seeds_is_biased_as_the_table_says(seeds, bias):
    drawn = np.random.default_rng(6).normal(size=(seeds, 20000))
    assert low_quantile(drawn).mean() - stats.norm.ppf(0.15) == pytest.approx(bias, abs=0.02)


def test_the_words_say_what_few_seeds_do_not_tell():
    assert describe_low_quantile([55, 38, 60, 43, 71]) == (
        "q0.15 over 5 training seeds: 41 (descriptive; seeds 38, 43, 55, 60, 71). With 97 % confidence the population "
        "0.15-quantile is <= 55; 5 seeds give no lower bound (needs 19)."
    )
    assert "with 96 % confidence it is >= 0" in describe_low_quantile(range(20))


def test_a_threshold_over_seeds_is_clipped_and_counts_the_undecided():
    rng = np.random.default_rng(7)
    means = np.array([[100.0, 100, 100, 20.5], [100, 100, 100, 19], [100, 100, 0, 20.1]])
    returns = means[:, :, None] + rng.normal(0, 0.01, (3, 4, 6))
    reached, undecided = threshold(returns, 20)
    assert reached.value == pytest.approx(np.mean([4, 3, 3]))
    assert 0 <= reached.low <= reached.high == 4
    assert undecided == 2


def test_a_threshold_of_one_run_goes_from_the_certain_to_the_possible():
    returns = np.array([[[60.0, 60, 60], [0, 0, 0], [0, 20, 60], [40, 0, 0]]])
    reached, undecided = threshold(returns, 20)
    assert (tuple(reached), undecided) == ((2, 1, 3), 2)


def test_a_single_episode_decides_nothing():
    reached, undecided = threshold(np.full((1, 3, 1), 100.0), 20)
    assert (tuple(reached), undecided) == ((3, None, None), None)


@given(st.lists(st.lists(st.integers(0, 300), min_size=4, max_size=4), min_size=1, max_size=6), st.integers(1, 300))
def test_the_ordered_curve_the_threshold_and_the_mean_are_one_object(rows, level):
    means = np.array(rows, float)
    curve = ordered(means)
    assert (np.diff(curve, axis=1) >= 0).all()
    assert curve.mean() == pytest.approx(means.mean())
    assert threshold(means[:, :, None], level).reached.value == pytest.approx((curve >= level).sum(axis=1).mean())


def test_the_tail_is_over_partners_within_each_seed():
    means = np.array([np.arange(20.0), np.arange(20.0) + 100])
    assert tail_mean(means).tolist() == [1, 101]  # the worst three of twenty
    assert tail_quantile(means) == pytest.approx([0.15 * 19, 100 + 0.15 * 19])
    assert tail_mean([[5.0, 1.0]]).tolist() == [1]


def test_the_tail_interval_covers():
    rng = np.random.default_rng(8)
    spread = rng.normal(100, 40, 20)
    truth = np.mean([tail_mean(spread + rng.normal(0, 14, (1, 20)))[0] for _ in range(4000)])
    covered = 0
    for _ in range(600):
        means = spread + rng.normal(0, 6, (5, 1)) + rng.normal(0, 14, (5, 20))
        _, low, high = t_interval(tail_mean(means))
        covered += low <= truth <= high
    assert 0.92 <= covered / 600 <= 0.98


def test_the_confidence_is_what_is_printed():
    assert (estimate.CONFIDENCE, statistics.LOW_QUANTILE) == (0.95, 0.15)
