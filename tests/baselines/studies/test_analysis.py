"""The registered analysis says what it should about blocks with known effects."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.baselines.studies.thesis_claim.analysis import (
    ALPHA,
    difference,
    family,
    paired,
    verdict,
    wording,
)
from overcooked_bench.baselines.studies.thesis_claim.power import power
from overcooked_bench.evaluation.comparing.permutation import holm

DRAWS = 1500
CAMPS = np.array([0.1] * 6 + [0.35] * 10)
"""Two camps of training runs, as self-play on forced_coordination has them."""


def normal(random, mean, spread, n):
    return random.normal(mean, spread, (DRAWS, n))


def camps(random, mean, spread, n):
    first, second = (random.choice(CAMPS, (DRAWS, n)) for _ in range(2))
    return mean + first - second + random.normal(0, spread / 10, (DRAWS, n))


@pytest.mark.parametrize("shape", [normal, camps])
@pytest.mark.parametrize("n", [20, 40])
def test_the_interval_covers_the_difference_in_95_of_100_studies(shape, n):
    found = [difference(values) for values in shape(np.random.default_rng(n), 0.04, 0.15, n)]
    covered = np.mean([one.low <= 0.04 <= one.high for one in found])
    assert covered == pytest.approx(0.95, abs=0.018)


@given(st.lists(st.lists(st.floats(-1, 1), min_size=3, max_size=8), min_size=1, max_size=6))
def test_an_interval_of_a_family_excludes_0_exactly_where_holm_rejects(samples):
    if min(np.std(values) for values in samples) < 1e-6:  # no test without a spread
        return
    found = family(samples)
    assert [one.adjusted for one in found] == holm([difference(values).p for values in samples])
    for one in found:
        if abs(one.adjusted - ALPHA) > 1e-9:
            assert (one.low > 0 or one.high < 0) == (one.adjusted < ALPHA)


def test_two_comparisons_without_a_difference_are_taken_for_one_in_5_of_100_studies_at_most():
    random, wrong = np.random.default_rng(1), 0
    for common, home, away in zip(*(normal(random, 0, 0.1, 40) for _ in range(3)), strict=True):
        found = family([common + home, common + away])
        wrong += any(one.low > 0 or one.high < 0 for one in found)
    assert wrong / DRAWS <= 0.065


@pytest.mark.parametrize(
    ("mean", "spread", "said"), [(0.12, 0.13, "supported"), (0.0, 0.07, "refuted"), (0.03, 0.2, "undecided")]
)
def test_the_verdict_is_right_in_most_studies(mean, spread, said):
    random = np.random.default_rng(2)
    studies = zip(normal(random, mean, spread, 40), normal(random, mean, spread, 40), strict=True)
    verdicts = [verdict(family(pair)[0]) for pair in studies]
    assert verdicts.count(said) / DRAWS > 0.75


def test_the_figures_of_power_are_what_simulated_studies_show():
    can, random = power(0.13, 40, ALPHA), np.random.default_rng(3)
    found = [difference(values) for values in normal(random, can.detects, 0.13, 40)]
    assert np.mean([one.low > 0 for one in found]) == pytest.approx(0.8, abs=0.035)
    none = [difference(values) for values in normal(random, 0.0, 0.13, 40)]
    assert np.mean([one.high < 0.05 for one in none]) == pytest.approx(can.refutes, abs=0.035)
    assert np.mean([one.high - one.low for one in none]) / 2 == pytest.approx(can.half, rel=0.02)


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ([0.1, 0.12, 0.11], "Supported: the population"),
        ([0.02, 0.021, 0.022], "Supported, but the difference is smaller than 0.05"),
        ([0.0, 0.01, -0.01], "Refuted: a difference of 0.05 or more"),
        ([-0.1, -0.12, -0.11], "Refuted: self-play"),
        ([-0.3, 0.3, 0.1], "Undecided"),
    ],
)
def test_each_outcome_has_its_sentence(values, said):
    assert wording(difference(values)).startswith(said)


def test_one_block_has_no_interval_and_unequal_blocks_are_not_paired():
    with pytest.raises(ValueError, match="two blocks at least"):
        difference([0.1])
    with pytest.raises(ValueError, match="2 and 1 blocks"):
        paired([1.0, 2.0], [1.0])
