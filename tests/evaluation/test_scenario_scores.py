"""The cooperation scenarios of a score."""

import json
from io import StringIO

import pytest
from rich.console import Console

from overcooked_bench.cli import main
from overcooked_bench.estimate import Estimate, t_interval
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.evaluation.scenario_scores import profile, suite_sha256
from overcooked_bench.evaluation.score import score
from overcooked_bench.evaluation.scores import read_scores
from overcooked_bench.evaluation.shown.tables import count_text, scenarios_table
from overcooked_bench.evaluation.shown.terminal import score_tables
from tests.evaluation.made import protocol_text

GREEDY_AND_STAY = """
from overcooked_bench import UnknownLayout, load_agent

TRAINING_SEEDS = 2

def make_agent(layout, training_seed):
    if layout != "cramped_room":
        raise UnknownLayout(f"never seen {layout}")
    return load_agent(("greedy", "stay")[training_seed], layout)
"""


@pytest.fixture(scope="module")
def scored(tmp_path_factory):
    home = tmp_path_factory.mktemp("home")
    (home / "two.py").write_text(GREEDY_AND_STAY)
    layouts = ["cramped_room", "coordination_ring"]
    rules = read_protocol(protocol_text(layouts=layouts), "tiny.yaml")
    return score(home / "two.py", rules, layouts=layouts, output=home / "out")


def test_training_seeds_are_taken_together(scored):
    one, other = (json.loads((scored.folder / f"scenarios-{seed}.json").read_text()) for seed in (0, 1))
    assert (one["agent"], one["training_seed"], other["training_seed"]) == ("two", 0, 1)
    assert one["passed"] > 0
    assert other["passed"] == 0
    card = scored.scores.scenarios
    total = card.total
    assert total.category == "total"
    assert total.not_attempted > 0
    assert total.attempted + total.not_attempted == len(card.scenarios)
    assert total.share.value == pytest.approx(total.passed / total.attempted)
    assert (total.share.low, total.share.high) == (0, 1), "two values say nothing with a t interval"
    assert sum(category.attempted for category in card.categories) == total.attempted
    layouts = {item["layout"].removesuffix("-mirrored") for item in one["items"]}
    assert layouts == {"cramped_room", "coordination_ring"}
    assert [item["id"] for item in one["items"]] == sorted(item["id"] for item in one["items"])


def test_they_are_in_all_files(scored):
    scores, folder, *_ = scored
    assert read_scores(folder) == scores
    total = scores.scenarios.total
    page = (folder / "report.html").read_text()
    assert "Cooperation scenarios" in page
    assert scores.scenarios.suite.sha256 in page
    shown = StringIO()
    Console(width=100, file=shown).print(score_tables(scores, explain=True))
    assert f" total {count_text(total.passed)} {count_text(total.attempted)} " in " ".join(shown.getvalue().split())


def record(scenario, status, category="state", mirrored=False, adapted=False, pair=()):
    scenarios = list(pair) or [scenario]
    name = f"{scenario}-pair" if pair else f"{scenario}-seat0"
    return dict(id=name, scenarios=scenarios, category=category, status=status, mirrored=mirrored, adapted=adapted)


def test_a_scenario_is_one_unit_and_what_was_not_attempted_is_apart():
    card = profile(
        [
            [
                *(record("A01", status) for status in ("passed", "passed", "passed", "failed")),
                record("A02", "not attempted"),
                record("B01", "failed", "partner"),
                record("B01", "passed", "partner", mirrored=True, adapted=True),
                record("B02", "passed", "partner", pair=("B02a", "B02b")),
            ]
        ]
    )
    assert {one.scenario: one.share for one in card.scenarios} == {"A01": 0.75, "A02": None, "B01": 0, "B02-pair": 1}
    state, partner = card.categories
    assert (state.attempted, state.passed, state.not_attempted, tuple(state.share)) == (1, 0.75, 1, (0.75, None, None))
    assert (partner.attempted, partner.passed, partner.share.value) == (2, 1, 0.5)
    assert (card.total.attempted, card.total.passed) == (3, 1.75)
    assert (card.suite.sha256, card.counted) == (suite_sha256(), "scenarios")


def test_nothing_attempted_is_no_share_and_such_a_seed_enters_no_mean():
    runs = [
        [record("A01", "not attempted"), record("B01", status, "partner")] for status in ("not attempted", "passed")
    ]
    card = profile(runs)
    state, partner = card.categories
    assert (state.attempted, state.share) == (0, None)
    assert (partner.attempted, tuple(partner.share)) == (0.5, (1, None, None))
    assert card.total.share == Estimate(1)
    table = scenarios_table(card)
    assert [[str(cell) for cell in row] for row in table.rows] == [
        ["state", "0", "0", "-", "1"],
        ["partner", "0.5", "0.5", "1.00", "0.5"],
    ]


def test_the_interval_of_a_method_is_over_its_seeds():
    card = profile([[record("A01", "passed"), record("A02", status)] for status in ("passed", "failed", "failed")])
    assert card.total.share == t_interval([1, 0.5, 0.5], 0, 1)


CLUMSY = """
class Clumsy:
    observation = 'state'

    def reset(self, layout, seats, seeds):
        self.late = False

    def act(self, states):
        return [4 if len(states) < 9 else 9] * len(states)


def make_agent(layout, training_seed):
    return Clumsy()
"""


def test_a_fault_in_a_scenario_leaves_a_whole_score(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "clumsy.py").write_text(CLUMSY)
    (tmp_path / "tiny.yaml").write_text(protocol_text())
    arguments = "--protocol", "tiny.yaml", "--workers", "1", "--layouts", "cramped_room"
    assert main(["score", "clumsy.py", *arguments]) == 1
    shown = capsys.readouterr()
    assert "cramped_room" in shown.out
    scores = read_scores("scores/clumsy-tiny")
    assert scores.layouts[0].layout == "cramped_room"
    assert scores.scenarios.total.passed == 0
    assert len(scores.faults) == 2, "the kitchen and its mirror image"
    for fault in scores.faults:
        assert fault.startswith("scenarios on cramped_room")
        assert fault in shown.err
        assert "9" in fault
    (record, *_) = json.loads((tmp_path / "scores/clumsy-tiny/scenarios.json").read_text())["items"]
    assert (record["status"], record["runs"]) == ("failed", 0)
    assert "9" in record["reason"]
