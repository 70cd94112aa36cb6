import json
from io import StringIO

import pytest
from rich.console import Console

from overcooked_bench.cli import main
from overcooked_bench.commands.score_card import play_scenarios
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.evaluation.score import score, with_scenarios
from overcooked_bench.evaluation.scores import read_scores
from overcooked_bench.evaluation.shown.tables import score_tables
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
    return score(home / "two.py", read_protocol(protocol_text(), "tiny.yaml"), output=home / "out")


@pytest.fixture(scope="module")
def card(scored):
    return play_scenarios(scored.folder.parent / "two.py", scored, ["cramped_room", "bottleneck"])


def test_training_seeds_are_taken_together(scored, card):
    one, other = (json.loads((scored.folder / f"scenarios-{seed}.json").read_text()) for seed in (0, 1))
    assert (one["agent"], one["training_seed"], other["training_seed"]) == ("two", 0, 1)
    assert one["passed"] > 0
    assert other["passed"] == 0
    total = card.total
    assert (total.category, total.items, total.passed) == ("total", one["n"], one["passed"] / 2)
    assert total.not_attempted == one["total"]["not_attempted"] > 0
    assert total.share.value == pytest.approx(one["total"]["score"]["value"] / 2)
    assert (total.share.low, total.share.high) == (0, 1), "two values say nothing with a t interval"
    assert sum(category.items for category in card.categories) == total.items
    layouts = {item["layout"].removesuffix("-mirrored") for item in one["items"]}
    assert layouts == {"cramped_room", "bottleneck"}


def test_the_card_is_in_all_files(scored, card):
    scores, folder = with_scenarios(scored, card)
    assert read_scores(folder / "score.json") == scores
    assert scores.scenarios == card
    page = (folder / "report.html").read_text()
    assert "Cooperation scenarios" in page
    assert card.suite.sha256 in page
    shown = StringIO()
    Console(width=100, file=shown).print(score_tables(scores))
    assert f" total {card.total.passed:g} {card.total.items} " in " ".join(shown.getvalue().split())


def test_layouts_without_scenarios_have_no_card(scored):
    assert play_scenarios(scored.folder.parent / "two.py", scored, []) is None


def test_a_fault_in_a_scenario_leaves_the_score(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "clumsy.py").write_text(
        "class Clumsy:\n"
        "    observation = 'state'\n\n"
        "    def reset(self, layout, seats, seeds):\n"
        "        self.late = False\n\n"
        "    def act(self, states):\n"
        "        return [4 if len(states) < 9 else 9] * len(states)\n\n\n"
        "def make_agent(layout, training_seed):\n"
        "    return Clumsy()\n"
    )
    (tmp_path / "tiny.yaml").write_text(protocol_text())
    assert main(["score", "clumsy.py", "--protocol", "tiny.yaml", "--workers", "1", "--layouts", "cramped_room"]) == 1
    shown = capsys.readouterr()
    assert "worst partner" in shown.out
    assert "returned the action 9" in shown.err
    assert read_scores("scores/clumsy-tiny/score.json").scenarios is None
