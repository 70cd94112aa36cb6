"""N and what goes with it, on examples that are worked out by hand."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench.evaluation.cells import Cells, PartnerLabel, SideBound
from overcooked_bench.evaluation.metric import find_metrics
from overcooked_bench.evaluation.protocol import Report
from overcooked_bench.evaluation.scores import ABOUT
from overcooked_bench.evaluation.summary import compute_rows

METRICS = {metric.facts.name: metric for metric in find_metrics()}
REPAIRED = Report(thresholds=(3,), estimators="repaired")


def label(name, stratum="own", weight=None, bounds=((0, 100),), home=None):
    found = bounds and tuple(SideBound(side, *ends) for side, ends in enumerate(bounds))
    return PartnerLabel(name, "trained", name * 8, stratum, weight=weight, bounds=found, home=home)


def cells(returns, partners, sides=None, layout="cramped_room", **more):
    """Cells of (S, P, E, 2) returns; sides is (S, P, E, 2), or all on side 0."""
    given = np.asarray(returns, float)
    zeros = np.zeros(given.shape)
    there = zeros.astype(int) if sides is None else np.broadcast_to(sides, given.shape)
    return Cells(layout, 20.0, tuple(partners), (0, 1), given, zeros, zeros, there, **more)


def rows(given, *names, report=REPAIRED):
    layouts = given if isinstance(given, list) else [given]
    return compute_rows(layouts, [METRICS[name] for name in names], report, overall=True)


def values(found, metric, layout="cramped_room", **about):
    """What the named entries of rows say -> the value, of rows that say nothing else."""
    return {
        tuple(getattr(row, key) for key in about): row.value
        for row in found
        if (row.metric, row.layout) == (metric, layout)
        and all((getattr(row, key) is None) == (key not in about) for key in ABOUT[1:])
    }


def test_strata_count_a_quarter_each_and_partners_by_their_weights():
    """Four strata of one partner or two, each met three times over: N of the partners 0.2, 0.8, 0.5, -0.1 and 1.2."""
    partners = [
        label("a", weight=0.75),
        label("b", weight=0.25),
        label("c", "human", bounds=((20, 80),)),
        label("d", "other"),
        label("e", "scripted", bounds=((0, 50),)),
    ]
    means = np.array([20, 80, 50, -10, 60])
    found = rows(cells(np.broadcast_to(means[None, :, None, None], (1, 5, 3, 2)), partners), "n", "h50", "worst_third")
    by_stratum = {"own": 0.35, "human": 0.5, "other": -0.1, "scripted": 1.2}
    assert values(found, "n", stratum=0) == {(name,): pytest.approx(value) for name, value in by_stratum.items()}
    (whole,) = [row for row in found if row.about == ("n", (), "cramped_room", *[None] * 5)]
    assert whole.value == pytest.approx(sum(by_stratum.values()) / 4)
    assert whole.per_repetition == pytest.approx([whole.value] * 3)
    assert values(found, "h50")[()] == pytest.approx(0.25 * 0.25 + 0.25 + 0.25)
    worst = (0.25 * -0.1 + (1 / 3 - 0.25) * 0.2) * 3
    assert values(found, "worst_third")[()] == pytest.approx(worst)
    assert values(found, "n", layout=None, stratum=0).keys() == {(name,) for name in by_stratum}


def test_a_partner_counts_half_from_each_side():
    """From side 0 between 20 and 120 points, from side 1 between 0 and 50; seats and sides are crossed."""
    partners = [label("a", bounds=((20, 120), (0, 50)))]
    sides = [[[[0, 1], [1, 0]]]]
    found = rows(cells([[[[70, 10], [30, 120]]]], partners, sides), "n")
    assert values(found, "n")[()] == pytest.approx((0.75 + 0.4) / 2)
    assert values(found, "n", side=0) == {(0,): pytest.approx(0.75), (1,): pytest.approx(0.4)}
    assert values(found, "n", seat=0) == {(0,): pytest.approx((0.5 + 0.6) / 2), (1,): pytest.approx((1.0 + 0.2) / 2)}
    (row,) = [row for row in found if row.partner == "a"]
    assert row.per_repetition == pytest.approx([(0.5 + 0.2) / 2, (1.0 + 0.6) / 2])


@given(st.integers(0, 2**32), st.integers(2, 12))
def test_a_run_alone_has_the_n_that_it_has_among_others(seed, episodes):
    """By seat, too, where start states are not on both sides alike; the mean over blocks is N, and they vary."""
    rng = np.random.default_rng(seed)
    partners = [label("a", bounds=((20, 120), (0, 50))), label("b", "human", bounds=((0, 100), (10, 60)))]
    sides = rng.integers(0, 2, (1, 2, episodes, 1)) ^ np.array([0, 1])
    returns = 20.0 * rng.integers(0, 6, sides.shape)
    alone = rows(cells(returns, partners, sides), "n", "h50", "worst_third")
    twice = rows(
        cells(np.tile(returns, (2, 1, 1, 1)), partners, np.tile(sides, (2, 1, 1, 1))), "n", "h50", "worst_third"
    )
    assert {row.about: row.value for row in alone} == pytest.approx({row.about: row.value for row in twice})
    for row in alone:
        assert np.mean(row.per_repetition) == pytest.approx(row.value, abs=1e-9)


def test_the_sides_of_a_seat_count_the_same_however_often_they_are_played():
    """From side 0, in three of ten start states, nothing of a hundred points; from side 1 all of them."""
    sides = np.array([[0, 1]] * 3 + [[1, 0]] * 7)[None, None]
    found = rows(cells(100.0 * sides, [label("a", bounds=((0, 100), (0, 100)))], sides), "n")
    assert values(found, "n", seat=0) == {(0,): pytest.approx(0.5), (1,): pytest.approx(0.5)}


def test_n_has_no_side_where_a_start_state_has_both_seats_on_one():
    partners = [label("a", bounds=((0, 100), (0, 100)))]
    found = rows(cells([[[[70, 10], [30, 20]]]], partners, [[[[0, 0], [1, 1]]]]), "n")
    assert values(found, "n", side=0) == {}


def test_a_method_is_averaged_over_layouts_seed_by_seed():
    partners = [label("a"), label("b", "human")]
    one, other = ([[[[20, 20]], [[40, 40]]], [[[60, 60]], [[80, 80]]]], [[[[70, 70]], [[90, 90]]], [[[30, 30]]] * 2])
    found = rows([cells(one, partners), cells(other, partners, layout="bottleneck")], "n", "h50")
    (whole,) = [row for row in found if row.about == ("n", (), *[None] * 6)]
    assert whole.per_repetition == pytest.approx([(0.3 + 0.8) / 2, (0.7 + 0.3) / 2])
    spread = abs(whole.per_repetition[0] - whole.per_repetition[1]) / 2
    assert whole.error == pytest.approx(spread)
    (share,) = [row for row in found if row.about == ("h50", (), *[None] * 6)]
    assert share.per_repetition == (0.5, 0.5)
    assert share.error > 0, "both seeds agree, and the next one need not"


def test_one_training_run_has_an_interval_over_partners():
    partners = [label("a"), label("b"), label("c", "human"), label("d", "human")]
    given = np.array([20.0, 40.0, 60.0, 100.0])[None, :, None, None] * np.ones((1, 4, 3, 2))
    found = rows(cells(given, partners), "n", "mean", "h50")
    (whole,) = [row for row in found if row.about == ("n", (), "cramped_room", *[None] * 5)]
    variance = 2 * 0.25**2 * 2 * (0.1**2 + 0.2**2)
    assert whole.error == pytest.approx(variance**0.5)
    assert whole.low < whole.value < whole.high
    (alone,) = [row for row in found if (row.metric, row.partner) == ("n", "b")]
    assert alone.error == pytest.approx((20**2 / 24 / 100**2 / 3) ** 0.5), "blocks all the same, but whole soups"
    (points,) = [row for row in found if (row.metric, row.partner, row.seat) == ("mean", "b", None)]
    assert points.error == pytest.approx((20**2 / 24 / 3) ** 0.5)
    (plain,) = [
        row
        for row in rows(cells(given, partners), "n", report=Report(thresholds=(3,)))
        if row.about == ("n", (), "cramped_room", *[None] * 5)
    ]
    assert plain.error == 0, "plain intervals are over episode blocks, which are the same here"


def test_home_and_away_are_shown_where_there_is_a_home():
    given = np.array([20.0, 40.0, 60.0])[None, :, None, None] * np.ones((1, 3, 2, 2))
    homes = {(True,): 0.2, (False,): 0.5}
    known = [label("a", home=True), label("b", home=False), label("c", home=False)]
    assert values(rows(cells(given, known), "n"), "n", home=0) == pytest.approx(homes)
    for home in (None, False):
        partners = [label(name, home=home) for name in "abc"]
        assert values(rows(cells(given, partners), "n"), "n", home=0) == {}


def test_without_bounds_there_is_no_n_and_the_mean_is_as_ever():
    found = rows(cells(np.full((1, 2, 2, 2), 40.0), [label("a", bounds=None), label("b")]), "n", "h50", "mean")
    assert {row.metric for row in found if row.partner is None} == {"mean"}


@pytest.mark.parametrize("seeds", [1, 3])
def test_the_return_with_itself_is_kept_for_each_repetition(seeds):
    own = np.arange(seeds * 4, dtype=float).reshape(seeds, 4)
    found = rows(cells(np.ones((seeds, 1, 2, 2)), [label("a")], self_play=own), "self_play")
    (whole,) = [row for row in found if row.layout is None]
    assert whole.per_repetition == tuple(own[0] if seeds == 1 else own.mean(axis=1))
    assert rows(cells(np.ones((seeds, 1, 2, 2)), [label("a")]), "self_play") == ()


def test_every_row_is_about_something_else():
    rng = np.random.default_rng(0)
    partners = [label("a", home=True), label("b", "human", home=False)]
    given = [cells(rng.uniform(0, 99, (3, 2, 4, 2)), partners, layout=name) for name in ("cramped_room", "bottleneck")]
    found = compute_rows(given, list(METRICS.values()), REPAIRED, overall=True)
    assert len({row.about for row in found}) == len(found)
    for row, name in product(found, ("low", "high")):
        assert getattr(row, name) is None or np.isfinite(getattr(row, name))
