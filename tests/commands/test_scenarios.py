import json
import re

import pytest

from overcooked_bench.cli import main
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.scenarios import CATEGORIES
from overcooked_bench.scenarios.language.loading import load_scenario, read_scenario
from overcooked_bench.scenarios.language.template import template
from tests.isolating import isolation_of
from tests.scenarios.writing import POT, YIELD, edited

POTTER = """
class Potter:
    observation = "lossless26"

    def reset(self, layout, seats, seeds):
        pass

    def act(self, observations):
        return [5] * len(observations)

def make_agent(layout, training_seed):
    return Potter()
"""


@pytest.fixture
def home(tmp_path, monkeypatch):
    """A working directory with an agent that only interacts, a scenario that it passes and one that it fails."""
    (tmp_path / "potter.py").write_text(POTTER)
    (tmp_path / "T02-pot.scenario.yaml").write_text(edited(POT, id="T02-pot", budget="200"))
    (tmp_path / "T01-yield.scenario.yaml").write_text(edited(YIELD, id="T01-yield"))
    monkeypatch.chdir(tmp_path)
    return tmp_path


def scenarios(*arguments):
    try:
        return main(["scenarios", *arguments])
    except SystemExit as stop:  # argparse
        return stop.code


@pytest.mark.slow
def test_run_tells_what_is_passed(home, capsys):
    assert scenarios("run", "T02-pot.scenario.yaml", "--agent", "potter.py") == 0
    assert re.search(r"state +4 +4 +1\.00 \[0\.21, 1\.00\]", capsys.readouterr().out)
    assert scenarios("run", ".", "--agent", "potter.py", "--report", "all.json") == 1
    shown = capsys.readouterr().out
    assert "failed  T01-yield-seat0: fails every run, as the agent is deterministic\n" in shown
    assert re.search(r"total +4 +8 ", shown)
    assert scenarios("run", ".", "--agent", "potter.py", "--json") == 1
    assert capsys.readouterr().out == (home / "all.json").read_text()
    told = json.loads((home / "all.json").read_text())
    assert (told["agent"], told["n"], told["passed"]) == ("potter.py", 8, 4)
    assert scenarios("run", ".", "--agent", "potter.py", "--category", "state", "--seat", "1", "--mirrored") == 0
    assert re.search(r"state +1 +1 ", capsys.readouterr().out)


@pytest.mark.slow
def test_run_shows_films(home, capsys):
    assert scenarios("run", "T01-yield.scenario.yaml", "--agent", "potter.py", "--film", "--seat", "0") == 1
    shown = capsys.readouterr().out
    assert "`A.holds(dish)` never held" in shown
    (command, *_) = re.findall("replay it: overcooked-bench scenarios (.*)", shown)
    assert command == "run T01-yield.scenario.yaml --agent potter.py --seat 0 --repeat 0"
    assert scenarios(*command.split()) == 1
    shown = capsys.readouterr().out
    assert "T01-yield-seat0, repeat 0: A stands in the way." in shown
    assert "step 0            step 1 " in shown
    assert "step 15" in shown
    assert "\x1b" not in shown
    assert scenarios("run", "P09-hand-over-onion-seat1-mirrored", "--agent", "stay", "--repeat", "3") == 1
    assert capsys.readouterr().out.startswith("P09-hand-over-onion-seat1-mirrored, repeat 3: ")


def test_compare_counts_what_tells_agents_apart(home, capsys):
    assert (
        scenarios("compare", "potter.py", "stay", "greedy", "--select", "T01-yield.scenario.yaml,T02-pot.scenario.yaml")
        == 0
    )
    assert capsys.readouterr().out.splitlines() == [
        "|                             | state | convention | all |",
        "|-----------------------------|------:|-----------:|----:|",
        "| potter.py                   |     4 |          0 |   4 |",
        "| stay                        |     0 |          0 |   0 |",
        "| greedy                      |     4 |          0 |   4 |",
        "| items                       |     4 |          4 |   8 |",
        "| items that discriminate     |     4 |          0 |   4 |",
        "| scenarios that discriminate |     1 |          0 |   1 |",
    ]
    assert scenarios("compare", "stay", "--select", "T02-pot.scenario.yaml", "--json") == 0
    assert len(json.loads(capsys.readouterr().out)["stay"]) == 4


def test_list_and_show(home, capsys):
    assert scenarios("list", "T01-yield.scenario.yaml", "T02-pot.scenario.yaml", "--json") == 0
    (first, second) = json.loads(capsys.readouterr().out)
    assert (first["id"], first["budget"], second["layout"]) == ("T01-yield", 15, "cramped_room")
    assert scenarios("list") == 0
    assert "C04-yield-pot-cell" in capsys.readouterr().out
    assert scenarios("show", "T01-yield.scenario.yaml", "--film", "--seat", "1", "--mirrored") == 0
    shown = capsys.readouterr().out
    for words in (
        "T01-yield-seat1-mirrored: convention, family T01, coordination_ring-mirrored",
        "[_]A^ B<o   ###",
        "A at (1, 1) holds nothing",
        "B's part, mirrored: {does: carry, insist: true}",
        "accept: B.pot >= 1 and A.holds(dish)",
        "budget: 15 steps",
        "a shortest solution, 7 steps",
    ):
        assert words in shown


def test_show_tells_histories_and_choices(home, capsys):
    told = edited(
        POT,
        id="T09-all",
        tags="[easy]",
        accept="[A.pot >= 1, A.serve >= 1]",
        never="A.drop >= 1",
        before="{A: [stay, up]}",
        pair="T09-both",
    )
    (home / "T09-all.scenario.yaml").write_text(told)
    (home / "T09-too.scenario.yaml").write_text(told.replace("T09-all", "T09-too"))
    assert scenarios("show", "T09-all.scenario.yaml") == 0
    shown = capsys.readouterr().out
    for words in (
        "accept one of:\n  A.pot >= 1\n",
        "never: A.drop",
        "before: A stay up; B stay stay\n",
        "pair: T09-both\n",
        "tags: easy",
    ):
        assert words in shown


def test_show_has_colours_in_a_terminal(home, monkeypatch, capsys):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True)
    assert scenarios("show", "C04") == 0
    assert "\x1b[1;38;5;" in capsys.readouterr().out
    monkeypatch.setenv("NO_COLOR", "1")
    assert scenarios("show", "C04") == 0
    assert "\x1b" not in capsys.readouterr().out


@pytest.mark.slow
def test_what_new_begins_stands_the_gates(home, capsys):
    assert scenarios("new", "X01-mine") == 0
    file = home / "X01-mine.scenario.yaml"
    assert load_scenario(file).id == "X01-mine"
    assert scenarios("new", "X01-mine") == 2
    assert "exists already" in capsys.readouterr().err
    assert scenarios("check", "X01-mine.scenario.yaml", "--film", "--lock") == 0
    shown = capsys.readouterr().out
    for words in ("X01-mine: mergeable: yes", "takes 3 steps, an agent has 9", "a shortest solution, 3 steps"):
        assert words in shown
    assert scenarios("list", "X01-mine.scenario.yaml", "--json") == 0
    assert json.loads(capsys.readouterr().out)[0]["shortest"] == 3
    file.write_text(file.read_text().replace("accept: A.pot >= 1", "accept: dist(A, B) >= 0"))
    assert scenarios("check", "X01-mine.scenario.yaml", "--json") == 1
    (report,) = json.loads(capsys.readouterr().out)
    assert not report["mergeable"]
    assert report["faults"]


@pytest.mark.parametrize("category", CATEGORIES)
def test_a_template_is_a_scenario(category):
    for layout in layout_names():
        found = read_scenario(template("X01-mine", layout, category), "mine", "X01-mine")
        assert (found.category, found.layout.name) == (category, layout)


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["run", "C04", "--agent", "gredy"], 2, "did you mean 'greedy'"),
        (["run", "C99", "--agent", "stay"], 2, "no scenario fits 'C99'"),
        (["run", "C04"], 2, "--agent"),
        (["run", "C04", "--agent", "stay", "--category", "stat"], 2, "no category stat; choose among state"),
        (["run", "C04", "--agent", "stay", "--category", "state"], 2, "nothing is left to play"),
        (["run", "C04", "--agent", "stay", "--repeats", "0"], 2, "give a whole number from 1"),
        (["run", "T02-pot.scenario.yaml", "--agent", "bad.py"], 1, "act returned the action 6 in row 0"),
        (["run", "nowhere.scenario.yaml", "--agent", "stay"], 2, "nowhere.scenario.yaml: cannot be read"),
        (["show", "broken.scenario.yaml"], 2, "broken.scenario.yaml:1"),
        (["show"], 2, "SELECT"),
        (["new", "X 1"], 2, "write letters, digits, - and _ alone"),
        (["new", "X01", "--layout", "cramped_rom"], 2, "cramped_rom"),
        (["check", "nowhere/"], 2, "nowhere"),
    ],
)
def test_mistakes_end_in_one_message(home, capsys, arguments, code, words):
    (home / "bad.py").write_text(POTTER.replace("[5]", "[6]"))
    (home / "broken.scenario.yaml").write_text("id: broken\n")
    assert scenarios(*arguments) == code
    said = capsys.readouterr().err
    assert words in said
    assert "Traceback" not in said


@pytest.mark.parametrize(
    ("act", "message"),
    [
        ("import os; os._exit(0)", "act, step 0: the worker process ended with exit code 0"),
        ("while True: pass", "act, step 0: no answer within 1 s"),
    ],
)
def test_an_agent_that_ends_or_blocks_its_process_does_not_end_the_command(home, capsys, act, message):
    (home / "hostile.py").write_text(
        POTTER.replace("    def act(self", f"    def act(self, seen):\n        {act}\n\n    def other(self")
    )
    assert scenarios("run", "T02-pot.scenario.yaml", "--agent", "hostile.py", "--act-timeout", "1") == 1
    assert message in capsys.readouterr().err


def test_an_agent_that_ends_its_process_while_it_is_imported(home, capsys):
    (home / "hostile.py").write_text("import os\nos._exit(0)\n")
    assert scenarios("compare", "hostile.py", "--select", "T02-pot.scenario.yaml") == 1
    assert "hostile.py: loading: the worker process ended with exit code 0" in capsys.readouterr().err


@pytest.mark.slow
def test_an_isolated_agent_passes_what_it_passes_here(home, capsys):
    isolation_of("strong")
    (home / "potter.py").write_text(POTTER)
    (home / "hostile.py").write_text(
        POTTER.replace("    def act(self", "    def act(self, seen):\n        1 / 0\n\n    def x(self")
    )
    said = []
    for more in ((), ("--isolate=strict",)):
        code = scenarios("run", "T02-pot.scenario.yaml", "--agent", "potter.py", "--json", *more)
        said.append((code, json.loads(capsys.readouterr().out)))
    assert said[0] == said[1]
    assert scenarios("run", "T02-pot.scenario.yaml", "--agent", "hostile.py", "--isolate") == 1
    assert "act() raised ZeroDivisionError" in capsys.readouterr().err
