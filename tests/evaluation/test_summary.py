"""From stored episodes to numbers: the unit of the intervals, and what is kept out of them."""

import json
import shutil
from itertools import product
from pathlib import Path

import msgspec
import numpy as np
import pytest

from overcooked_bench.estimate import Estimate, t_interval
from overcooked_bench.evaluation.cells import PartnerLabel, pack_labels, read_cells
from overcooked_bench.evaluation.comparing.compare import compare
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.games.episode import Episode
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.games.streams import draw_salt
from overcooked_bench.evaluation.protocol import Report
from overcooked_bench.evaluation.scores import SCHEMA, ScoresError, read_scores
from overcooked_bench.evaluation.statistics import low_quantile
from overcooked_bench.evaluation.summary import describe_interval, recompute, summarise
from tests.evaluation.made import block, changed, reporting

PARTNERS = {"ann": "trained", "bob": "trained", "cat": "scripted", "stay": "floor"}
OLD = Path(__file__).parents[1] / "data" / "upgrades" / "score-1"


def episode(layout, s, e, who, k, kind, points, own=0):
    return Episode(layout, s, e, who, k, 0, who * 8, kind, float(points), 0.0, 0.0, own, 1, "", b"")


def summarised(tmp_path, protocol, returns, name="a", layouts=("cramped_room",), **facts):
    """Scores (S, P, E, 2) returns of PARTNERS, the same on every layout."""
    seeds, _, episodes, _ = returns.shape
    rules = changed(protocol, episodes=episodes, layouts=tuple(layouts))
    with Store(tmp_path / f"{name}.sqlite", {"agent": "bob" * 8, **facts}) as store:
        for layout in layouts:
            for s, e in np.ndindex(seeds, episodes):
                rows = [
                    episode(layout, s, e, who, k, kind, returns[s, p, e, k], p)
                    for p, (who, kind) in enumerate(PARTNERS.items())
                    for k in (0, 1)
                ]
                store.add_block((layout, s, e), rows)
        return summarise(store, rules, training_seeds=seeds, finished=layouts)


def mean(scores, **about):
    return scores.find(layout="cramped_room", **about).estimate


def drawn(seeds, episodes=6):
    rng = np.random.default_rng(0)
    low = np.array([20.0, 60.0, 100.0, 5.0])[None, :, None, None]
    return np.maximum(0, low + rng.normal(0, 8, (seeds, 4, 1, 1)) + rng.normal(0, 8, (seeds, 4, episodes, 2)))


def test_with_seeds_the_seed_is_the_unit(tmp_path, protocol):
    returns = drawn(5)
    scores = summarised(tmp_path, protocol, returns)
    counting = returns[:, :3]
    per_seed = counting.mean(axis=(1, 2, 3))
    assert tuple(mean(scores)) == pytest.approx(tuple(t_interval(per_seed)))
    assert tuple(mean(scores)) == pytest.approx(tuple(scores.overall))
    assert scores.find().per_repetition == pytest.approx(per_seed)
    ordered = np.sort(counting.mean(axis=(2, 3)), axis=1)
    for rank in range(3):
        params = {"rank": rank + 1}
        point = scores.find("curve", layout="cramped_room", params=params)
        assert tuple(point.estimate) == pytest.approx(tuple(t_interval(ordered[:, rank])))
        quantile = scores.find("curve_quantile", layout="cramped_room", params=params)
        assert quantile.value == pytest.approx(low_quantile(ordered[:, rank]))
    assert "5 training seeds" in scores.layouts[0].remark


def test_permuting_seeds_within_one_partner_changes_the_interval_and_nothing_else(tmp_path, protocol):
    returns = drawn(5)
    permuted = returns.copy()
    permuted[:, 1] = permuted[[3, 0, 4, 1, 2], 1]
    before = mean(summarised(tmp_path, protocol, returns, "before"))
    after = mean(summarised(tmp_path, protocol, permuted, "after"))
    assert before.value == pytest.approx(after.value)
    assert abs((before.high - before.low) - (after.high - after.low)) > 0.1


def test_with_one_run_the_episode_block_is_the_unit(tmp_path, protocol):
    returns = drawn(1)
    scores = summarised(tmp_path, protocol, returns)
    blocks = returns[0, :3].mean(axis=(0, 2))
    assert tuple(mean(scores)) == pytest.approx(tuple(t_interval(blocks)))
    assert scores.find(layout="cramped_room").per_repetition == pytest.approx(blocks)
    assert scores.layouts[0].remark is None
    assert all(row.low is None for row in scores.select("curve"))
    assert scores.find("tail_mean", layout="cramped_room").low is None
    assert not list(scores.select("curve_quantile"))


def test_floors_are_shown_and_enter_nothing(tmp_path, protocol):
    returns = drawn(2)
    other = returns.copy()
    other[:, 3] += 500
    first = summarised(tmp_path, protocol, returns, "first")
    second = summarised(tmp_path, protocol, other, "second")
    (layout,) = first.layouts
    assert [label.name for label in layout.partners if not label.counts] == ["stay"]
    assert mean(second, partner="stay").value > 500
    without = [row for row in first.rows if row.partner != "stay"]
    assert without == [row for row in second.rows if row.partner != "stay"]
    assert "stay" not in [label.name for label, _ in first.with_partners(layout)]


def test_seats_partners_strata_and_thresholds(tmp_path, protocol):
    returns = np.zeros((1, 4, 2, 2))
    returns[0, 0], returns[0, 1], returns[0, 2] = 20, [[0, 100], [0, 100]], 5
    labels = [PartnerLabel("bob", "trained", "", "self-play", "corner")]
    scores = summarised(tmp_path, protocol, returns, partners=pack_labels({"cramped_room": labels}))
    assert [mean(scores, seat=seat).value for seat in (0, 1)] == pytest.approx([25 / 3, 125 / 3])
    (layout,) = scores.layouts
    assert [(label.name, row.value, label.is_ego) for label, row in scores.with_partners(layout)] == [
        ("cat", 5, False),
        ("ann", 20, False),
        ("bob", 50, True),
    ]
    assert {row.stratum: row.value for row in scores.select("mean", seat=None) if row.stratum} == {
        "trained": 20,
        "self-play": 50,
        "scripted": 5,
    }
    assert [label.convention for label in layout.partners] == [None, "corner", None, None]
    reached = {
        (row.seat, row.partner): row.value for row in scores.select("threshold", params={"soups": 1}, stratum=None)
    }
    assert reached == {
        **{(None, None): pytest.approx(2 / 3), (0, None): pytest.approx(1 / 3), (1, None): pytest.approx(2 / 3)},
        **{(None, "ann"): 1, (None, "bob"): 1, (None, "cat"): 0, (None, "stay"): 0},
    }
    assert scores.find("threshold", params={"soups": 1}).value == pytest.approx(2 / 3), "over all layouts, too"
    assert scores.find("threshold", layout="cramped_room", stratum="self-play", params={"soups": 1}).value == 1
    assert [scores.find(f"{who}_soups", layout="cramped_room", partner="cat").value for who in ("ego", "partner")] == [
        *(2, 1),
    ]


def test_thresholds_count_soups_of_the_layouts_own_value(tmp_path, protocol):
    cheap = tmp_path / "cheap.layout"
    cheap.write_text("XXPXX\nO1  O\nX  2X\nXDXSX\n---\nsoup_reward: 10\n")
    returns = np.full((1, 4, 2, 2), 20.0)
    scores = summarised(tmp_path, protocol, returns, layouts=[str(cheap)])
    assert scores.layouts[0].soup_points == 10
    assert [
        row.value for row in scores.select("threshold", layout=str(cheap), seat=None, stratum=None, partner=None)
    ] == [
        *(1, 0),
    ]


def test_a_training_seed_is_averaged_over_layouts_before_the_interval(tmp_path, protocol):
    """Two layouts on which the seeds go opposite ways: their mean does not vary, each of them does."""
    layouts = "cramped_room", "coordination_ring"
    rules = changed(protocol, episodes=1, layouts=layouts)
    with Store(tmp_path / "two.sqlite", {"agent": "x"}) as store:
        for layout, points in zip(layouts, ([20, 40, 60], [60, 40, 20]), strict=True):
            for s, reward in enumerate(points):
                store.add_block((layout, s, 0), [episode(layout, s, 0, "ann", k, "trained", reward) for k in (0, 1)])
        scores = summarise(store, rules, training_seeds=3, finished=layouts)
    for layout in layouts:
        row = scores.find(layout=layout)
        assert row.low < row.value == 40
    assert scores.overall == Estimate(40, 40, 40)


def test_a_missing_episode_is_one_message(tmp_path):
    with Store(tmp_path / "a.sqlite", {"agent": "x"}) as store:
        store.add_block(("cramped_room", 0, 0), [episode("cramped_room", 0, 0, "ann", 0, "trained", 20)])
        with pytest.raises(StoreError, match=r"a\.sqlite: there is no episode on cramped_room, .* partner ann, seat 1"):
            read_cells(store, ["cramped_room"], 1, 1, (0, 1))
        store.add_block(("cramped_room", 0, 1), [episode("cramped_room", 0, 1, "ann", 0, "floor", 20)])
        with pytest.raises(StoreError, match=r"a\.sqlite: .*another partner than before"):
            read_cells(store, ["cramped_room"], 1, 2, (0,))


def test_the_interval_says_what_it_is_about(protocol):
    plain, repaired = protocol.report, reporting(protocol, estimators="repaired").report
    assert "5 training seeds" in describe_interval(5, 10, plain)
    assert "given these start states and random streams" in describe_interval(5, 10, repaired)
    assert "nothing about retraining" in describe_interval(1, 10, plain)
    assert "over the partners of each stratum" in describe_interval(1, 1, repaired)
    assert describe_interval(1, 1, plain).startswith("No intervals")


def test_a_score_of_schema_1_is_read_and_its_store_gives_the_same_numbers():
    old = read_scores(OLD)
    assert old.schema == SCHEMA
    assert (old.agent.name, old.protocol.name, old.pool.name, old.unranked) == ("greedy", "mini", "dev-v0", None)
    total = old.scenarios.total
    assert (old.scenarios.counted, total.attempted + total.not_attempted) == ("situations", 210)
    again = recompute(OLD)
    numbers = {row.about: tuple(row.estimate) for row in again.rows}
    compared = 0
    for row in old.rows:
        for mine, theirs in zip(row.estimate, numbers[row.about], strict=True):
            assert (mine is None) == (theirs is None) or row.metric.endswith("_soups"), row.about
            assert mine is None or mine == pytest.approx(theirs, rel=1e-12, abs=1e-12), row.about
        compared += 1
    assert compared == 2 * (1 + 2 + 3 + 3 + 2 + 7 + 9 * 5) + 1
    assert again.overall == old.overall
    assert [layout.partners for layout in again.layouts] == [layout.partners for layout in old.layouts]


def test_a_score_of_schema_2_is_read_and_its_store_gives_the_same_numbers():
    old, again = read_scores(OLD.parent / "score-2"), recompute(OLD.parent / "score-2")
    assert (old.schema, old.agent.name, old.protocol.name, old.unranked) == (SCHEMA, "greedy", "mini", None)
    assert old.overall == again.overall
    total = old.scenarios.total
    assert (old.scenarios.counted, total.passed, total.attempted, total.not_attempted) == ("situations", 167, 210, 0)
    numbers = {row.about: row for row in again.rows}
    for row in old.rows:
        same = numbers[row.about]
        assert (row.low, row.high) == pytest.approx((same.low, same.high)), row.about
        assert row.per_repetition == pytest.approx(same.per_repetition), row.about
    assert {row.metric for row in again.rows} >= {"pots", "hand_overs", "blocked", "idle"}, "episodes were replayed"


def test_the_same_games_are_reported_in_another_way(protocol):
    report = Report(thresholds=(2,), metrics=("threshold",), estimators="repaired")
    again = recompute(OLD.parent / "score-2", report)
    assert again.settings.report == report
    assert {row.params["soups"] for row in again.select("threshold", layout="cramped_room")} == {2}
    assert {row.metric for row in again.rows} == {"mean", "threshold"}
    assert "over the partners of each stratum" in again.interval


@pytest.mark.parametrize(
    ("seeds", "kind", "unranked"),
    [(1, "agent", None), (4, "runs", "4 training runs; a method has 5 at least"), (5, "method", None)],
)
def test_a_method_has_five_training_runs(seeds, kind, unranked, tmp_path, protocol):
    returns = drawn(seeds)
    ranks = summarised(tmp_path, reporting(protocol, headlines=("mean",)), returns, agent="x")
    assert ranks.kind == kind
    assert (ranks.unranked is None) == (unranked is None)
    assert unranked is None or unranked in ranks.unranked
    assert ranks.overall == ranks.find().estimate, "an overall score is shown in any case"
    assert summarised(tmp_path, protocol, returns, "old", agent="x").unranked is None
    never = summarised(tmp_path, reporting(protocol, ranked=False), returns, "never", agent="x")
    assert (never.unranked or "").split(";")[0] == "the protocol tiny does not rank"


@pytest.mark.parametrize(
    ("facts", "why"),
    [
        ({"seed": "7"}, "it has the seed 7, and ranked scores have the seed 0"),
        ({"salt": "my lucky one"}, "its salt is neither the protocol's nor drawn by --salt fresh"),
        ({"salt": draw_salt()}, None),
        ({"pool": "b" * 64, "pool_name": "mine"}, "the pool mine is not that of the protocol tiny"),
        ({"pool": "a" * 64}, None),
        ({"agent": "bob" * 8, "agent_name": "bob"}, "bob is itself among the partners"),
        ({"agent": "stay" * 8}, None),
    ],
)
def test_only_the_protocols_own_games_rank(facts, why, protocol, tmp_path):
    """An official run has a salt that was drawn for it; a floor that is scored meets no partner of its own."""
    rules = changed(protocol, pool_sha256="a" * 64)
    scores = summarised(tmp_path, rules, drawn(1), **{"agent": "x", **facts})
    assert scores.unranked == why
    assert scores.overall is not None


def test_without_bounds_no_score_ranks_by_n(protocol, tmp_path):
    rules = reporting(protocol, headlines=("n", "h50"), estimators="repaired")
    scores = summarised(tmp_path, rules, drawn(1), agent="x", pool="b" * 64, pool_name="mine")
    assert scores.overall is None
    assert scores.unranked == "the pool mine has no bounds for all partners, so there is no N"


@pytest.mark.parametrize(("runs", "different"), [([0, 0, 0, 0, 0], 1), ([0, 1, 0, 2, 3], 4)])
def test_copies_of_a_training_run_have_no_interval_and_no_rank(runs, different, protocol, tmp_path):
    returns = drawn(5)
    rules = reporting(protocol, headlines=("mean",), estimators="repaired")
    scores = summarised(tmp_path, rules, returns[runs], agent="x")
    assert scores.unranked == f"{different} of its 5 training runs differ, the others are copies"
    assert {(row.low, row.high, row.error) for row in scores.rows} == {(None, None, None)}
    assert scores.overall == Estimate(pytest.approx(returns[runs][:, :3].mean()))
    assert f"{different} of 5" in scores.interval
    other = summarised(tmp_path, rules, returns - 5, "other", agent="y")
    assert other.unranked is None
    for metric in ("mean", "threshold"):
        compared = compare(scores, other, metric=metric)
        for one in compared.metrics[0].pairs[0].differences:
            assert (one.difference.interval, one.p, one.better) == (None, None, None)
        assert compared.interval.startswith("No intervals")
        assert compared.metrics[0].sights == ()


def test_declined_layouts_of_schema_1_leave_no_overall(tmp_path):
    content = json.loads((OLD / "score.json").read_text())
    content["layouts"].pop()
    content["not_attempted"] = ["forced_coordination"]
    (tmp_path / "score.json").write_text(json.dumps(content))
    scores = read_scores(tmp_path / "score.json")
    assert (scores.overall, [one.layout for one in scores.declined]) == (None, ["forced_coordination"])
    assert "forced_coordination" in scores.unranked


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"schema": 4}, "its schema is 4; this version reads 3"),
        ({"schema": None}, "its schema is None"),
        ({"layouts": [1]}, "not a score.json of schema 1"),
        ({"settings": []}, "not a score.json of schema 1"),
        ({"overall": {"value": "x"}}, "not a score.json"),
    ],
)
def test_a_broken_score_json_is_refused(change, words, tmp_path):
    content = json.loads((OLD / "score.json").read_text()) | change
    (tmp_path / "score.json").write_text(json.dumps(content))
    with pytest.raises(ScoresError, match=words) as refused:
        read_scores(tmp_path)
    assert str(tmp_path) in str(refused.value)


def test_what_cannot_be_computed_again_is_one_message(tmp_path):
    shutil.copy(OLD / "episodes.sqlite", tmp_path)
    (tmp_path / "episodes.sqlite").write_bytes((OLD / "episodes.sqlite").read_bytes()[:30_000])
    with pytest.raises(StoreError, match=r"episodes\.sqlite"):
        recompute(tmp_path)


@pytest.mark.parametrize(("seeds", "finished"), [("2", 1), ("1000000000", 0)])
def test_a_layout_counts_once_all_training_seeds_have_played_it(seeds, finished, protocol, tmp_path):
    notes = {"settings": msgspec.json.encode(protocol).decode(), "training_seeds": seeds}
    with Store(tmp_path / "episodes.sqlite", {"agent": "x"}, notes) as store:
        for key in product([0, 1], [0, 1]):
            store.add_block(
                ("cramped_room", *key), play_block(block(protocol, training_seed=key[0], episodes=(key[1],))).episodes
            )
    assert len(recompute(tmp_path).layouts) == finished


def test_a_number_of_training_seeds_that_is_none_is_one_message(protocol, tmp_path):
    notes = {"settings": msgspec.json.encode(protocol).decode(), "training_seeds": "many"}
    Store(tmp_path / "episodes.sqlite", {"agent": "x"}, notes).close()
    with pytest.raises(StoreError, match=r"episodes\.sqlite: what identifies the score .*training_seeds"):
        recompute(tmp_path)
