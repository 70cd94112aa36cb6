"""From stored episodes to numbers: the unit of the intervals, and what is kept out of them."""

import types

import msgspec
import numpy as np
import pytest

from overcooked_bench.estimate import t_interval
from overcooked_bench.evaluation.games.episode import Episode
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.shown.tables import _worth
from overcooked_bench.evaluation.statistics import low_quantile
from overcooked_bench.evaluation.summary import compute_layouts, describe_interval
from tests.evaluation.made import changed, reporting

PARTNERS = {"ann": "trained", "bob": "trained", "cat": "scripted", "stay": "floor"}


def summarise(tmp_path, protocol, returns, name="a", layout="cramped_room"):
    """Scores (S, P, E, 2) returns of PARTNERS on a layout."""
    seeds, _, episodes, _ = returns.shape
    rules = changed(protocol, episodes=episodes)
    with Store(tmp_path / f"{name}.sqlite", {"agent": "x"}) as store:
        for s, e in np.ndindex(seeds, episodes):
            rows = [
                Episode(layout, s, e, who, k, 0, who * 8, kind, float(returns[s, p, e, k]), 0.0, 0.0, p, 1, "", b"")
                for p, (who, kind) in enumerate(PARTNERS.items())
                for k in (0, 1)
            ]
            store.add_block((layout, s, e), rows)
        (score,), overall = compute_layouts(store, rules, [layout], seeds, "bob" * 8)
    return score, overall


def drawn(seeds, episodes=6):
    rng = np.random.default_rng(0)
    low = np.array([20.0, 60.0, 100.0, 5.0])[None, :, None, None]
    return np.maximum(0, low + rng.normal(0, 8, (seeds, 4, 1, 1)) + rng.normal(0, 8, (seeds, 4, episodes, 2)))


def test_with_seeds_the_seed_is_the_unit(tmp_path, protocol):
    returns = drawn(5)
    score, overall = summarise(tmp_path, protocol, returns)
    counting = returns[:, :3]
    assert tuple(msgspec.structs.astuple(score.mean)) == pytest.approx(tuple(t_interval(counting.mean(axis=(1, 2, 3)))))
    assert score.mean.value == pytest.approx(overall.value)
    assert score.mean.low == pytest.approx(overall.low)
    ordered = np.sort(counting.mean(axis=(2, 3)), axis=1)
    for rank, point in enumerate(score.curve):
        assert tuple(msgspec.structs.astuple(point.mean)) == pytest.approx(tuple(t_interval(ordered[:, rank])))
        assert point.low_quantile == pytest.approx(low_quantile(ordered[:, rank]))
    assert "5 training seeds" in score.low_quantile


def test_permuting_seeds_within_one_partner_changes_the_interval_and_nothing_else(tmp_path, protocol):
    returns = drawn(5)
    permuted = returns.copy()
    permuted[:, 1] = permuted[[3, 0, 4, 1, 2], 1]
    before, _ = summarise(tmp_path, protocol, returns, "before")
    after, _ = summarise(tmp_path, protocol, permuted, "after")
    assert before.mean.value == pytest.approx(after.mean.value)
    assert abs((before.mean.high - before.mean.low) - (after.mean.high - after.mean.low)) > 0.1


def test_with_one_run_the_episode_block_is_the_unit(tmp_path, protocol):
    returns = drawn(1)
    score, _ = summarise(tmp_path, protocol, returns)
    assert tuple(msgspec.structs.astuple(score.mean)) == pytest.approx(
        tuple(t_interval(returns[0, :3].mean(axis=(0, 2))))
    )
    assert score.low_quantile is None
    assert all(point.mean.low is None for point in score.curve)
    assert score.tail_mean.low is None


def test_floors_are_shown_and_enter_nothing(tmp_path, protocol):
    returns = drawn(2)
    without, other = returns.copy(), returns.copy()
    other[:, 3] += 500
    first, _ = summarise(tmp_path, protocol, without, "first")
    second, _ = summarise(tmp_path, protocol, other, "second")
    assert [cell.partner for cell in first.floors] == ["stay"]
    assert second.floors[0].mean.value > 500
    assert (first.partners, first.mean, first.thresholds) == (3, second.mean, second.thresholds)
    assert "stay" not in [cell.partner for cell in first.cells]


def test_seats_partners_and_thresholds(tmp_path, protocol):
    returns = np.zeros((1, 4, 2, 2))
    returns[0, 0], returns[0, 1], returns[0, 2] = 20, [[0, 100], [0, 100]], 5
    score, _ = summarise(tmp_path, protocol, returns)
    assert [seat.value for seat in score.seats] == pytest.approx([25 / 3, 125 / 3])
    assert [(cell.partner, cell.mean.value, cell.is_ego) for cell in score.cells] == [
        ("cat", 5, False),
        ("ann", 20, False),
        ("bob", 50, True),
    ]
    assert (score.worst.partner, score.best.partner) == ("cat", "bob")
    assert [(t.soups, t.reached.value, t.share) for t in score.thresholds] == [(1, 2, 2 / 3), (3, 0, 0)]
    assert (score.worst.ego_soups, score.worst.partner_soups) == (2, 1)


def test_thresholds_count_soups_of_the_layouts_own_value(tmp_path, protocol):
    cheap = tmp_path / "cheap.layout"
    cheap.write_text("XXPXX\nO  2O\nX1  X\nXDXSX\n---\nsoup_reward: 10\n")
    rules = reporting(protocol, thresholds=(1, 2, 3))
    two_soups = np.full((1, 4, 2, 2), 20.0)
    score, _ = summarise(tmp_path, rules, two_soups, layout=str(cheap))
    assert [(t.soups, t.share) for t in score.thresholds] == [(1, 1), (2, 1), (3, 0)]
    assert score.soup_points == 10
    assert "one soup = 10" in _worth(types.SimpleNamespace(layouts=[score]))
    plain, _ = summarise(tmp_path, rules, two_soups, "plain")
    assert [t.share for t in plain.thresholds] == [1, 0, 0]


def test_the_interval_says_what_it_is_about():
    assert "5 training seeds" in describe_interval(5, 10)
    assert "given these start states and random streams" in describe_interval(5, 10)
    assert "nothing about retraining" in describe_interval(1, 10)
    assert describe_interval(1, 1).startswith("No intervals")


def test_a_training_seed_is_averaged_over_layouts_before_the_interval(tmp_path, protocol):
    """Two layouts on which the seeds go opposite ways: their mean does not vary, each of them does."""
    rules, layouts = changed(protocol, episodes=1), ["cramped_room", "coordination_ring"]
    with Store(tmp_path / "two.sqlite", {"agent": "x"}) as store:
        for layout, points in zip(layouts, ([20.0, 40.0, 60.0], [60.0, 40.0, 20.0]), strict=True):
            for s, reward in enumerate(points):
                rows = [
                    Episode(layout, s, 0, "ann", k, 0, "a" * 64, "trained", reward, 0.0, 0.0, 1, 1, "", b"")
                    for k in (0, 1)
                ]
                store.add_block((layout, s, 0), rows)
        scores, overall = compute_layouts(store, rules, layouts, 3, "")
    assert all(score.mean.low < score.mean.value == 40 for score in scores)
    assert msgspec.structs.astuple(overall) == (40, 40, 40)
