"""A score.json whose entries do not fit together is refused when it is read, and never when it is shown."""

import json

import msgspec
import pytest

from overcooked_bench.evaluation.scores import ScoresError, read_scores
from overcooked_bench.evaluation.shown.report import write_report
from tests.evaluation.comparing.made import REPORT, agent


@pytest.fixture(scope="module")
def content():
    return agent(0, report=msgspec.structs.replace(REPORT, metrics=(*REPORT.metrics, "curve"))).to_json()


def metric(it, name, **changes):
    next(one for one in it["metrics"] if one["name"] == name).update(changes)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (lambda it: metric(it, "threshold", label="≥{nokey}"), "label"),
        (lambda it: metric(it, "threshold", label="{soups.__format__.__globals__}"), "label"),
        (lambda it: metric(it, "threshold", label="{soups:a|b}"), "label"),
        (lambda it: metric(it, "mean", label="{soups:g}"), "label"),
        (lambda it: metric(it, "mean", digits=-1), "digits"),
        (lambda it: metric(it, "mean", digits=10), "digits"),
        (lambda it: it.update(metrics=[]), "metrics do not list 'mean'"),
        (lambda it: it["rows"].append({"metric": "new", "value": 1.0}), "metrics do not list 'new'"),
        (lambda it: it["run"].update(versions=3), "run.versions"),
        (lambda it: it["layouts"][0].update(soup_points=0), "soup_points"),
        (lambda it: it["settings"]["report"].update(thresholds=[1e308]), "thresholds"),
        (lambda it: it.update(rows=[]), "no row has the mean with 'own-0' on 'cramped_room'"),
        (lambda it: it["layouts"][0]["partners"][0].update(name=""), "no row has the mean with ''"),
        (lambda it: it["rows"].append({"metric": "curve", "value": 1.0}), "a row of 'curve' has no parameter 'rank'"),
        (lambda it: it["rows"][0].update(high=1e308), r"rows.*high"),
        (lambda it: it.update(training_seeds=-3), "training_seeds"),
        (lambda it: it.update(training_seeds=0), "training_seeds"),
        (lambda it: it.update(training_seeds=1001), "training_seeds"),
    ],
    ids=[
        *("no such parameter", "attributes", "no such word", "a parameter of the mean", "no digits", "many digits"),
        *("no metrics", "a metric without facts", "versions", "soup points", "thresholds", "no rows", "no name"),
        *("no rank", "a huge number", "negative seeds", "no seeds", "many seeds"),
    ],
)
def test_what_could_not_be_shown_is_not_read(change, said, content, tmp_path):
    changed = json.loads(content)
    change(changed)
    (tmp_path / "score.json").write_text(json.dumps(changed))
    with pytest.raises(ScoresError, match=f"score.json: not a score.json .*{said}"):
        read_scores(tmp_path)


def test_braces_that_are_no_parameter_are_a_label_like_any_other(content, tmp_path):
    changed = json.loads(content)
    metric(changed, "mean", label="{")
    for layout in changed["layouts"]:
        layout["partners"] = []  # as in the scores of reference agents
    (tmp_path / "score.json").write_text(json.dumps(changed))
    write_report(read_scores(tmp_path), tmp_path)
    assert "{" in (tmp_path / "report.html").read_text()
