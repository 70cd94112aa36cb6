"""Two scores of the same protocol, and what cannot be compared."""

import json
from pathlib import Path

import msgspec
import numpy as np
import pytest

from overcooked_bench.cli import main
from overcooked_bench.estimate import Estimate, t_interval, welch_interval
from overcooked_bench.evaluation.compare import CompareError, compare
from overcooked_bench.evaluation.protocol import read_protocol
from tests.evaluation.made import protocol_text, score, write_agent

OLD = Path(__file__).parents[1] / "data" / "upgrades" / "score-1"


@pytest.fixture(scope="module")
def pair(tmp_path_factory):
    """Scores of `greedy` and `stay` over three episode blocks."""
    home = tmp_path_factory.mktemp("pair")
    rules = read_protocol(protocol_text(episodes=3, horizon=120), "p.yaml")
    return [score(agent, rules, output=home / agent) for agent in ("greedy", "stay")]


def of_layout(found):
    """The difference on the only layout, all partners and seats together."""
    return next(one for one in found.differences if one.layout == "cramped_room")


def test_episode_blocks_are_compared_one_by_one(pair):
    mine, theirs = (scored.scores for scored in pair)
    found = compare(mine, theirs)
    first, second = (np.array(scores.find(layout="cramped_room").per_repetition) for scores in (mine, theirs))
    overall, layout = found.differences[0], of_layout(found)
    assert overall.layout is None
    assert layout.difference == t_interval(first - second)
    assert (layout.first, layout.second) == (first.mean(), second.mean())
    assert layout.difference.value > 0
    assert "3 episode blocks that both agents played" in found.interval
    back = compare(theirs, mine).differences[0].difference
    assert tuple(back) == pytest.approx((-overall.difference.value, -overall.difference.high, -overall.difference.low))


def test_an_agent_does_not_differ_from_itself(pair):
    for metric in ("mean", "threshold", "tail_mean"):
        for one in compare(pair[0].folder, pair[0].folder / "score.json", metric).differences:
            assert one.difference.value == 0
            assert one.difference.interval in (None, (0, 0))


@pytest.mark.slow
def test_training_seeds_are_independent_samples(tmp_path, protocol):
    scores = [
        score(write_agent(tmp_path / f"{n}.py", training_seeds=n), protocol, output=tmp_path / str(n)).scores
        for n in (2, 3)
    ]
    values = [one.find(layout="cramped_room").per_repetition for one in scores]
    found = compare(*scores)
    assert of_layout(found).difference == welch_interval(*values)
    assert "Welch intervals over 2 and 3 training seeds" in found.interval


@pytest.mark.slow
def test_one_run_against_several_has_no_interval(tmp_path, pair, protocol):
    one, several = (
        score(write_agent(tmp_path / f"{n}.py", training_seeds=n), protocol, output=tmp_path / str(n)).scores
        for n in (1, 2)
    )
    found = compare(one, several)
    assert found.differences[0].difference.interval is None
    assert "several training seeds and the other a single one" in found.interval


@pytest.mark.parametrize("what", ["protocol", "pool", "seed", "salt"])
def test_other_games_are_not_compared(what, pair):
    mine, theirs = (scored.scores for scored in pair)
    other = {"seed": 1, "salt": "x"}.get(what) or msgspec.structs.replace(mine.protocol, sha256="0" * 64)
    with pytest.raises(CompareError, match=f"scored with a different {what}"):
        compare(mine, msgspec.structs.replace(theirs, **{what: other}))


def test_an_unknown_metric_is_answered_with_those_that_are_there(pair):
    with pytest.raises(CompareError, match=r"no metric 'men' in both scores; they have mean, threshold"):
        compare(pair[0].scores, pair[1].scores, "men")


def test_scores_of_schema_1_are_compared_without_intervals():
    found = compare(OLD, OLD, "tail_mean")
    assert found.differences[0].difference == Estimate(0)
    assert "stored no values per repetition" in found.interval


def test_the_command_prints_a_table_or_json(pair, capsys):
    folders = [str(scored.folder) for scored in pair]
    assert main(["compare", *folders]) == 0
    shown = capsys.readouterr().out
    for words in ("cramped_room", "greedy", "stay", "difference [95 %]", "mean of layouts", "episode blocks"):
        assert words in shown
    assert main(["compare", *folders, "--metric", "threshold", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert [one["params"] for one in found["differences"]] == [{"soups": 1.0}, {"soups": 3.0}]
    assert main(["compare", folders[0], "nowhere"]) == 2
    assert "nowhere" in capsys.readouterr().err
