"""Scores of the same games: methods by their training seeds, agents by their partners, and what is not compared."""

import json
from pathlib import Path

import msgspec
import numpy as np
import pytest

from overcooked_bench.cli import main
from overcooked_bench.estimate import Estimate, t_interval, welch_interval
from overcooked_bench.evaluation.comparing.compare import CompareError, compare
from overcooked_bench.evaluation.comparing.permutation import over_seeds, over_units
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.evaluation.shown.comparison import whole
from tests.evaluation.comparing.made import LAYOUTS, PLAY, REPORT, agent, method, partners, scores
from tests.evaluation.made import protocol_text, score, write_agent

OLD = Path(__file__).parents[2] / "data" / "upgrades" / "score-1"


def found(comparison, metric="n", pair=0, **about):
    """The difference of a metric that is about exactly this."""
    (compared,) = [one for one in comparison.metrics if one.metric.name == metric]
    where = {"layout": None, "seat": None, "side": None, "stratum": None, "partner": None, **about}
    return next(
        one for one in compared.pairs[pair].differences if all(getattr(one, key) == v for key, v in where.items())
    )


def test_methods_are_compared_over_their_training_seeds():
    mine, theirs = method(0, 70), method(1, 50, name="other")
    comparison = compare(mine, theirs)
    assert (comparison.kind, [one.metric.name for one in comparison.metrics]) == ("methods", ["n", "h50"])
    for layout in (None, *LAYOUTS):
        runs = [one.find("n", layout=layout).per_repetition for one in (mine, theirs)]
        one = found(comparison, layout=layout)
        assert tuple(one.difference) == pytest.approx(tuple(welch_interval(*runs)))
        assert (one.better, one.p) == (1, over_seeds(*runs))
    assert found(comparison).p == pytest.approx(2 / 252)
    assert "5 training seeds of each (Welch)" in comparison.interval
    assert "at least 0.0079" in comparison.test
    value, low, high = found(comparison).difference
    assert tuple(found(compare(theirs, mine)).difference) == pytest.approx((-value, -high, -low))


def test_what_repairs_the_interval_of_a_count_repairs_that_of_a_difference():
    """All seeds reach all partners: without the repair the difference would have no width."""
    mine, theirs = (scores(name, np.full((2, 3, 8), level)) for name, level in (("a", 90), ("b", 80)))
    difference = found(compare(mine, theirs), "h50").difference
    error = mine.find("h50").error
    assert difference.value == 0
    assert difference.high == pytest.approx(2.776 * error * 2**0.5, rel=1e-3)
    assert error > 0


def test_two_agents_are_compared_over_partners_by_what_each_adds():
    """Every partner of four strata, which have a quarter each, is worth the same here: a mean of 24 differences."""
    mine, theirs = agent(0, 66), agent(1, name="other")
    comparison = compare(mine, theirs)
    one = found(comparison)
    ours, their = (
        {(row.layout, row.partner): row.value for row in s.select("n") if row.partner} for s in (mine, theirs)
    )
    each = np.array([ours[key] - their[key] for key in ours])
    assert len(each) == 24
    assert one.difference.value == pytest.approx(each.mean()) == pytest.approx(one.first - one.second)
    assert one.better == pytest.approx((each > 0).mean())
    assert one.p == over_units(each)
    assert one.difference.low < each.mean() < one.difference.high
    assert comparison.kind == "agents"
    assert "one artefact" in comparison.interval
    human = found(comparison, stratum="human", layout=LAYOUTS[0])
    assert human.difference.value == pytest.approx(
        np.mean([ours[LAYOUTS[0], f"human-{i}"] - their[LAYOUTS[0], f"human-{i}"] for i in range(3)])
    )
    assert found(comparison, partner="human-0", layout=LAYOUTS[0]).difference.interval is None


def test_what_partners_are_worth_cancels():
    """Paired over partners: twenty times the difference between partners makes the interval no wider."""
    rng = np.random.default_rng(3)
    noise = rng.normal(0, 3, (2, 2, 1, 12))
    for spread in (1, 20):
        levels = spread * np.arange(12)
        mine, theirs = (scores(name, levels + one + noise[i]) for i, (name, one) in enumerate([("a", 5), ("b", 0)]))
        _, low, high = found(compare(mine, theirs)).difference
        assert high - low < 0.1
        assert low > 0


def test_agents_that_reach_the_same_partners_have_a_width_too():
    mine, theirs = (scores(name, np.full((2, 1, 12), level)) for name, level in (("a", 90), ("b", 80)))
    one = found(compare(mine, theirs), "h50")
    assert (one.difference.value, one.better, one.p) == (0, pytest.approx(0.5), 1)
    assert 0 < one.difference.high < 0.2  # as if one partner more on each layout were reached by one of them alone


def test_several_scores_are_compared_pair_by_pair_with_holms_adjustment():
    three = [method(seed, level, name=str(seed)) for seed, level in enumerate((50, 52, 80))]
    comparison = compare(*three, metric="n")
    assert [(pair.first, pair.second) for pair in comparison.metrics[0].pairs] == [(0, 1), (0, 2), (1, 2)]
    plain, adjusted = ([getattr(found(comparison, pair=i), key) for i in range(3)] for key in ("p", "adjusted"))
    assert plain[1] == plain[2] == pytest.approx(2 / 252)
    assert adjusted == pytest.approx([plain[0], 3 * plain[1], 3 * plain[1]])
    assert "adjusted for 3 pairs" in comparison.test
    assert found(compare(*three[:2])).adjusted is None


def test_it_is_said_when_no_pair_can_be_significant():
    few = [method(seed, seeds=3, name=str(seed)) for seed in range(2)]
    assert "No difference can have p of .05 or less then; that takes 4 training seeds of each." in compare(*few).test
    assert "No difference" not in compare(*(method(seed, name=str(seed)) for seed in range(4))).test  # 6 pairs, 5 seeds


def test_it_is_said_when_there_are_too_many_scores_for_any_number_of_seeds():
    report = msgspec.structs.replace(REPORT, metrics=(), headlines=())
    one = scores("method", np.random.default_rng(0).normal(60, 9, (1, 5, 4)), report=report)
    test = compare(*([one] * 50), metric="mean").test
    assert test.endswith("No difference can have p of .05 or less then; compare fewer scores at a time.")


@pytest.mark.parametrize("about", [{"seat": 0}, {"side": 1}])
def test_agents_have_no_interval_over_partners_where_these_are_not_known_by_seat_or_side(about):
    both = {"labels": partners(sides=2), "sides": (0, 1)}
    mine, theirs = (agent(number, name=str(number), **both) for number in range(2))
    assert found(compare(mine, theirs)).difference.interval is not None
    one = found(compare(mine, theirs), layout=LAYOUTS[0], **about).difference
    assert one.interval is None
    assert one.value == pytest.approx(
        mine.find("n", layout=LAYOUTS[0], **about).value - theirs.find("n", layout=LAYOUTS[0], **about).value
    )
    points = compare(mine, theirs, metric="mean")
    assert found(points, "mean", layout=LAYOUTS[0], seat=0).difference.interval is not None, "known by partner and seat"


def test_what_the_training_seeds_buy_is_part_of_the_result():
    mine, theirs = method(0), method(1, name="other")
    comparison = compare(mine, theirs, metric="n")
    whole, *layouts = comparison.metrics[0].sights
    variances = [np.var(one.find("n").per_repetition, ddof=1) for one in (mine, theirs)]
    assert whole.deviation == pytest.approx(np.mean(variances) ** 0.5)
    assert whole.seen == pytest.approx(2.306 * whole.deviation * (2 / 5) ** 0.5, rel=1e-3)
    assert [one.layout for one in layouts] == list(LAYOUTS)
    assert compare(agent(0), agent(1)).metrics[0].sights == ()


def test_unequal_numbers_of_seeds_are_refused():
    with pytest.raises(CompareError, match=r"training seeds: a 5, b 3\. .*TRAINING_SEEDS = 5 of each, or .* = 3"):
        compare(method(name="a"), method(name="b", seeds=3))


def test_a_method_is_not_compared_with_an_agent():
    with pytest.raises(CompareError, match=r"a 1, b 5\. A method is not compared with an agent of one training run"):
        compare(agent(name="a"), method(name="b"))


def test_one_score_alone_is_not_compared():
    with pytest.raises(CompareError, match="1 score given; give two at least"):
        compare(method())


@pytest.mark.parametrize("what", ["pool", "seed", "salt"])
def test_other_games_are_not_compared(what):
    other = {"seed": 1, "salt": "x"}.get(what)
    theirs = msgspec.structs.replace(method(1), **{what: other})
    with pytest.raises(CompareError, match=f"scored with a different {what}"):
        compare(method(0), theirs)


def test_protocols_that_play_differently_are_not_compared_and_the_difference_is_named():
    other = msgspec.structs.replace(PLAY, horizon=200)
    with pytest.raises(CompareError, match=r"different protocol \(.* and .*\): horizon 400 and 200; score both"):
        compare(method(0), method(1, played=other))


def test_scores_in_memory_that_are_reported_differently_need_their_folders():
    other = msgspec.structs.replace(REPORT, thresholds=(2,))
    with pytest.raises(CompareError, match="b was reported differently than a; give its folder"):
        compare(method(0, name="a"), method(1, name="b", report=other))


def test_an_unknown_metric_is_answered_with_those_that_are_there():
    with pytest.raises(CompareError, match=r"no metric 'men' in the scores of all of a, b; they have n, h50, mean"):
        compare(method(name="a"), method(1, name="b"), metric="men")


def test_agents_of_one_name_are_distinguished_by_their_hashes():
    other = msgspec.structs.replace(method(1), agent=msgspec.structs.replace(method().agent, sha256="f" * 64))
    assert [one.name for one in compare(method(), other).entrants] == ["method (6d657468)", "method (ffffffff)"]


def test_scores_of_schema_1_are_compared_without_intervals():
    comparison = compare(OLD, OLD, metric="tail_mean")
    assert comparison.metrics[0].pairs[0].differences[0].difference == Estimate(0)
    assert "no values per repetition" in comparison.interval
    assert comparison.test is None


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """Scores of `greedy` and `stay` over three episode blocks, with a single partner."""
    home = tmp_path_factory.mktemp("pair")
    rules = read_protocol(protocol_text(episodes=3, horizon=120), "p.yaml")
    return [score(agent, rules, output=home / agent) for agent in ("greedy", "stay")]


def test_with_a_single_partner_agents_are_compared_over_start_states(pair):
    mine, theirs = (scored.scores for scored in pair)
    comparison = compare(mine, theirs)
    runs = [np.array(one.find(layout="cramped_room").per_repetition) for one in (mine, theirs)]
    one = found(comparison, "mean", layout="cramped_room")
    assert one.difference == t_interval(runs[0] - runs[1])
    assert (one.first, one.second) == (runs[0].mean(), runs[1].mean())


def test_an_agent_does_not_differ_from_itself(pair):
    for metric in ("mean", "threshold", "tail_mean"):
        comparison = compare(pair[0].folder, pair[0].folder / "score.json", metric=metric)
        for one in comparison.metrics[0].pairs[0].differences:
            assert one.difference.value == 0
            assert one.difference.interval in (None, (0, 0))


@pytest.mark.slow
def test_a_score_that_is_reported_differently_is_computed_again_from_its_episodes(pair, tmp_path):
    rules = read_protocol(protocol_text(episodes=3, horizon=120, thresholds=[2]), "p.yaml")
    other = score(write_agent(tmp_path / "other.py"), rules, output=tmp_path / "other")
    for source in (other.folder, other.folder / "score.json"):
        comparison = compare(pair[0].folder, source, metric="threshold")
        assert [one.computed_again for one in comparison.entrants] == [False, True]
        assert [one.params["soups"] for one in whole(comparison.metrics[0].pairs[0]) if one.layout] == [1, 3]
    (other.folder / "episodes.sqlite").unlink()
    assert main(["compare", str(pair[0].folder), str(other.folder)]) == 2


def test_the_command_prints_a_table_or_json_and_writes_a_page(pair, capsys, tmp_path):
    folders = [str(scored.folder) for scored in pair]
    assert main(["compare", *folders, "--output", str(tmp_path / "new")]) == 0
    shown = capsys.readouterr().out
    for words in ("cramped_room", "greedy", "stay", "difference [95 %]", "mean of layouts", "over the partners"):
        assert words in shown
    assert (tmp_path / "new" / "comparison.html").stat().st_size > 2000
    assert main(["compare", *folders, "--metric", "threshold", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [one["params"] for one in told["metrics"][0]["pairs"][0]["differences"][:2]] == [
        {"soups": 1.0},
        {"soups": 3.0},
    ]
    assert main(["compare", folders[0], "nowhere"]) == 2
    assert "nowhere" in capsys.readouterr().err
