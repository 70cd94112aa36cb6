"""The normalised score on examples that are worked out by hand."""

import numpy as np
import pytest

from overcooked_bench.agents.pools.records import Bound, Entry
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.pools.normalised import normalised, partner_shares, side_means, weighted_mean


def partner(name, stratum="own", weight=None, bounds=((0, 100),)):
    return Entry(
        name=name,
        layout="forced_coordination",
        reference=None,
        role="partner",
        stratum=stratum,
        lineage=name,
        weight=weight,
        bounds=tuple(
            Bound(
                side=side,
                floor=floor,
                floor_agent="stay",
                ceiling=ceiling,
                low=ceiling,
                high=ceiling,
                episodes=100,
                responder="greedy",
                responder_sha256="0" * 64,
            )
            for side, (floor, ceiling) in enumerate(bounds)
        ),
    )


def test_a_partner_with_two_sides_counts_half_from_each():
    pool = [partner("both", bounds=((20, 120), (0, 50))), partner("flat", bounds=((0, 200), (0, 200)))]
    returns = np.array([[[[70, 50], [20, 90]], [[0, 100], [0, 100]]]])
    sides = np.array([[[[0, 1], [1, 0]], [[0, 1], [0, 1]]]])
    means = side_means(returns, sides)
    assert means.tolist() == [[[80, 35], [0, 100]]]
    values = normalised(means, pool)
    assert values[0].tolist() == [[0.6, 0.7], [0.0, 0.5]]
    assert weighted_mean(values, partner_shares(pool)) == pytest.approx([(0.65 + 0.25) / 2])


def test_strata_share_the_score_and_partners_their_stratum():
    pool = [
        partner("a", "own", 0.75),
        partner("b", "own", 0.25),
        partner("c", "human"),
        partner("d", "scripted", 1.0),
        partner("e", "other-trainers", 0.5),
        partner("f", "other-trainers", 0.5),
    ]
    assert partner_shares(pool).tolist() == pytest.approx([0.1875, 0.0625, 0.25, 0.25, 0.125, 0.125])
    values = np.array([[[1.0], [0.0], [0.5], [-0.1], [1.2], [0.0]]])
    assert weighted_mean(values, partner_shares(pool)) == pytest.approx([0.1875 + 0.125 - 0.025 + 0.15])
    without = partner_shares(pool[2:])  # without a stratum, the others share its part
    assert without.tolist() == pytest.approx([1 / 3, 1 / 3, 1 / 6, 1 / 6])


def test_the_floor_is_zero_and_the_ceiling_one_and_nothing_is_clipped():
    values = normalised([[[30.0]], [[90.0]], [[120.0]], [[0.0]]], [partner("a", bounds=((30, 90),))])
    assert values.ravel().tolist() == [0.0, 1.0, 1.5, -0.5]


def test_a_side_that_was_not_played_is_left_out_and_a_partner_must_not_be():
    pool = [partner("both", bounds=((0, 100), (0, 100)))]
    means = side_means([[[[50.0, 70.0]]]], [[[[1, 1]]]], count=2)
    assert np.isnan(means[0, 0, 0])
    assert weighted_mean(normalised(means, pool), [1.0]).tolist() == [0.6]
    with pytest.raises(ValueError, match="no episode with a partner"):
        weighted_mean([[[np.nan, np.nan]]], [1.0])


def test_partners_without_usable_bounds_or_weights_are_refused():
    with pytest.raises(WrongUse, match="bare has no floor and ceiling for side 0"):
        normalised([[[1.0]]], [partner("bare", bounds=())])
    with pytest.raises(WrongUse, match="not above the floor"):
        normalised([[[1.0]]], [partner("flat", bounds=((40, 40),))])
    with pytest.raises(WrongUse, match="1 of 2 partners of the stratum 'own' have a weight"):
        partner_shares([partner("a", weight=1.0), partner("b")])


def test_a_partner_of_weight_0_counts_only_where_it_is_looked_at_alone():
    some = [partner("a", weight=1.0), partner("b", weight=0.0)]
    assert partner_shares(some).tolist() == [1.0, 0.0]
    assert partner_shares(some[1:]).tolist() == [1.0]
