import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.estimate import t_interval, wilson
from overcooked_bench.evaluation.explaining.shares import mean_interval, share_interval

PARTNERS = [f"p{i % 31}" for i in range(50)]


def width(estimate):
    low, high = estimate.interval
    return high - low


@pytest.mark.parametrize("hits", [[False] * 50, [True] * 50])
def test_what_never_happened_in_fifty_moments_may_still_happen(hits):
    assert 0.05 < width(share_interval(hits, PARTNERS)) < 0.09


def test_single_moments_of_as_many_partners_are_independent():
    hits, partners = np.arange(50) % 2 == 0, [f"p{i}" for i in range(50)]
    assert tuple(share_interval(hits, partners)) == pytest.approx(tuple(wilson(25, 50)))


@given(st.lists(st.tuples(st.booleans(), st.integers(0, 9), st.integers(0, 4)), min_size=2, max_size=60))
def test_more_in_common_never_narrows_an_interval(moments):
    hits, partners, seeds = zip(*moments, strict=True)
    both = share_interval(hits, partners, seeds)
    assert both.value == pytest.approx(np.mean(hits))
    for units in (partners, seeds):
        one = share_interval(hits, units)
        if one.interval:
            assert 0 <= both.interval[0] <= both.value + 1e-12
            assert both.value - 1e-12 <= both.interval[1] <= 1
            assert width(both) >= width(one) - 1e-12
            assert width(one) >= width(wilson(sum(hits), len(hits))) - 1e-12


def test_one_partner_is_no_sample():
    assert share_interval([True, False], ["a", "a"], [0, 0]).interval is None
    assert mean_interval([1, 2], ["a", "a"], [0, 0]).interval is None


def test_the_mean_of_equal_units_is_that_of_their_means():
    values, units = [1, 3, 2, 2, 0, 5], ["a", "a", "b", "b", "c", "c"]
    assert mean_interval(values, units) == t_interval([2, 2, 2.5], lowest=0)
    assert width(mean_interval(values, units, [0, 1, 0, 1, 0, 1])) == pytest.approx(
        max(width(mean_interval(values, units)), width(mean_interval(values, [0, 1, 0, 1, 0, 1])))
    )


@pytest.mark.parametrize(
    ("share", "habit", "seeds"),
    [(0.25, 0.0, 1), (0.25, 0.6, 1), (0.05, 0.3, 1), (0.25, 0.3, 5), (0.5, 1.0, 5)],
)
def test_intervals_cover_what_they_say(share, habit, seeds):
    """Partners and training seeds have shares of their own; `habit` is how far these are from the mean, from 0 to 1."""
    rng, covered = np.random.default_rng(0), 0
    draws = 400
    for _ in range(draws):
        own = beta(rng, share, habit, 31)
        of_seed = rng.normal(0, 0.1 * (seeds > 1), seeds)
        seed = np.arange(50) % seeds
        chance = np.clip(own[np.arange(50) % 31] + of_seed[seed], 0, 1)
        found = share_interval(rng.random(50) < chance, PARTNERS, seed.tolist())
        covered += found.interval[0] <= share <= found.interval[1]
    assert covered / draws >= 0.93


def test_moments_as_units_would_not_cover():
    """The counter-example: what it is about to count 50 moments of five training seeds as 50 draws."""
    rng, pooled, whole = np.random.default_rng(0), 0, 0
    seeds = np.arange(50) % 5
    for _ in range(400):
        hits = rng.random(50) < beta(rng, 0.4, 0.7, 5)[seeds]
        pooled += wilson(hits.sum(), 50).low <= 0.4 <= wilson(hits.sum(), 50).high
        found = share_interval(hits, PARTNERS, seeds.tolist())
        whole += found.low <= 0.4 <= found.high
    assert pooled / 400 < 0.75
    assert whole / 400 >= 0.93


def beta(rng, mean, spread, size):
    """Shares with a mean, from all the same (0) to all or nothing (1)."""
    if spread == 0:
        return np.full(size, mean)
    if spread == 1:
        return (rng.random(size) < mean).astype(float)
    strength = 1 / spread**2 - 1
    return rng.beta(mean * strength, (1 - mean) * strength, size)
