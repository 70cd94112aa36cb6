"""A metric is one file: score.json, terminal, report and comparisons follow from it."""

import sys
from io import StringIO

import numpy as np
import pytest
from rich.console import Console

from overcooked_bench.evaluation import metrics
from overcooked_bench.evaluation.comparing.compare import compare
from overcooked_bench.evaluation.metric import find_metrics
from overcooked_bench.evaluation.scores import read_scores
from overcooked_bench.evaluation.shown.terminal import score_tables
from tests.evaluation.made import score

BEST = '''
"""The mean return with the best partner."""

from overcooked_bench.evaluation.metric import Metric, MetricFacts

METRIC = Metric(
    facts=MetricFacts(name="best_partner", label="best {power:g}", digits=2, note="best: of all partners."),
    per_repetition=lambda cells, power: cells.means.max(axis=1) ** power,
    params=lambda report, cells: [{"power": 1}],
    by=("overall", "layout", "seat"),
)
'''


@pytest.fixture
def added(tmp_path, monkeypatch):
    """A folder with one more metric."""
    (tmp_path / "more").mkdir()
    (tmp_path / "more" / "best_partner.py").write_text(BEST)
    monkeypatch.setattr(metrics, "__path__", [*metrics.__path__, str(tmp_path / "more")])
    yield
    sys.modules.pop(f"{metrics.__name__}.best_partner", None)


def test_every_file_is_a_metric_with_its_own_name():
    found = find_metrics()
    assert [metric.facts.name for metric in found][:4] == ["n", "h50", "worst_third", "mean"]
    for metric in found:
        module = sys.modules[f"{metrics.__name__}.{metric.facts.name}"]
        assert module.METRIC is metric
        assert module.__doc__


def test_one_file_adds_a_metric_everywhere(added, protocol, tmp_path):
    scored = score("greedy", protocol, output=tmp_path / "out")
    scores = read_scores(scored.folder)
    row = scores.find("best_partner", layout="cramped_room", params={"power": 1})
    _, best = scores.with_partners(scores.layouts[0])[-1]
    assert row.value == pytest.approx(best.value)
    assert len(row.per_repetition) == 1
    assert scores.find("best_partner", params={"power": 1}).value == row.value
    console = Console(width=120, file=StringIO())
    console.print(score_tables(scores))
    page = (scored.folder / "report.html").read_text()
    for text in (console.file.getvalue(), page):
        assert "best 1" in text
        assert f"{row.value:.2f}" in text
        assert "best: of all partners." in " ".join(text.split())
    stay = score("stay", protocol, output=tmp_path / "stay").scores
    (overall, *_) = compare(scores, stay, metric="best_partner").metrics[0].pairs[0].differences
    theirs = stay.find("best_partner", params={"power": 1}).value
    assert overall.difference.value == pytest.approx(row.value - theirs)


def test_a_score_with_a_metric_that_is_not_there_any_more_is_shown(added, protocol, tmp_path, monkeypatch):
    folder = score("greedy", protocol, output=tmp_path / "out").folder
    monkeypatch.undo()
    assert "best_partner" not in [metric.facts.name for metric in find_metrics()]
    console = Console(width=120, file=StringIO())
    console.print(score_tables(read_scores(folder)))
    assert "best 1" in console.file.getvalue()


def test_the_overall_mean_is_that_of_the_repetitions(protocol, tmp_path):
    scores = score("greedy", protocol, output=tmp_path / "out").scores
    rows = [scores.find(layout=layout.layout).per_repetition for layout in scores.layouts]
    assert scores.find().per_repetition == pytest.approx(np.mean(rows, axis=0))
