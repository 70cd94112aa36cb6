"""The plugin as users meet it: pytest runs inside of pytest, on small scenarios."""

import json
import re
import shlex
import subprocess
import sys
from importlib import import_module
from xml.etree import ElementTree

import hypothesis  # noqa: F401
import pytest

from overcooked_bench.agents import catalogue  # noqa: F401
from overcooked_bench.cli import main
from overcooked_bench.scenarios import CATEGORIES
from overcooked_bench.scenarios.items import items
from overcooked_bench.scenarios.plugin import bench, summary  # noqa: F401
from overcooked_bench.scenarios.results import SCHEMA
from overcooked_bench.scenarios.runner import run_items
from overcooked_bench.scenarios.shown import explaining
from overcooked_bench.scenarios.solving import fuzzing  # noqa: F401
from overcooked_bench.scenarios.solving.solver import solve
from tests.isolating import isolation_of
from tests.scenarios.players import player
from tests.scenarios.writing import POT, YIELD, edited, scenario

FAILED, USAGE = 1, 4
PLAYER = """
from overcooked_bench.agents import uniforms
import numpy as np

class Player:
    observation = "lossless26"
    chance = 1.0

    def reset(self, layout, seats, seeds):
        self.seeds, self.step = seeds, 0

    def act(self, observations):
        self.step += 1
        return np.where((self.step == 1) & (uniforms(self.seeds, 0) < self.chance), 5, 4)

def make_agent(layout, training_seed):
    return Player()

def half(layout, training_seed):
    player = Player()
    player.chance = 0.5
    return player
"""


@pytest.fixture(autouse=True)
def nothing_is_solved_yet(monkeypatch):
    """Other tests of the same process may have solved these scenarios, and what was solved is remembered."""
    monkeypatch.setattr("overcooked_bench.scenarios.solving.lock._SOLVED", {})


@pytest.fixture(scope="module", autouse=True)
def loaded():
    """An inner run forgets all modules that it was the first to import, and numba cannot be loaded twice."""
    explaining.explain(run_items(player(0.0), items([scenario(POT)]))[0], "player")
    solve(scenario(POT).seated(0), 3)


@pytest.fixture(scope="module")
def networks():
    """Torch is there before pytester is, which forgets what was imported since."""
    return import_module("overcooked_bench.agents.policies.neural")


@pytest.fixture
def kitchens(pytester):
    """A folder with an agent and two scenarios: it passes the first one and fails the second."""
    pytester.makepyfile(mine=PLAYER)
    write(pytester, T02=edited(POT, id="T02-pot", tags="[easy]"), T01=edited(YIELD, id="T01-yield"))
    return pytester


def write(pytester, **texts):
    for text in texts.values():
        name = text.partition("id: ")[2].partition("\n")[0]
        (pytester.path / f"{name}.scenario.yaml").write_text(text)


def run(pytester, *arguments):
    strict = ("--strict-markers", "--strict-config", "-Werror")
    others = ("-pno:cacheprovider", "-pno:benchmark", "-pno:hypothesispytest")  # would be loaded anew in every run
    return pytester.runpytest_inprocess(*strict, *others, *arguments)


def collected(pytester, *arguments):
    lines = run(pytester, "--collect-only", "-q", *arguments).outlines
    return [line.rpartition("::")[2] for line in lines if "::" in line]


def test_every_item_says_what_was_wrong_and_how_to_see_it_again(kitchens, capsys):
    report, junit = "out/report.json", "junit.xml"
    done = run(kitchens, "--agent", "mine.py:half", "--scenario-report", report, f"--junitxml={junit}")
    assert done.ret == FAILED
    done.assert_outcomes(failed=8)
    done.stdout.fnmatch_lines(
        [
            "scenarios: mine.py:half, mode sample, 20 repeats",
            "*_ T02-pot-seat1-mirrored _*",
            "T02-pot-seat1-mirrored: ?* of 20 runs passed: 0.?? [[]0.??, 0.??[]]; 0.8 is needed",
            "why: One step is enough.",
            "T02-pot-seat1-mirrored, repeat *, not reached within 3 steps: A.pot >= 1",
            "  `A.pot >= 1` never held",
            "step 0            step 1            step 2            step 3",
            "<O>   A^o   <O>*",
            "replay it: overcooked-bench scenarios run T02-pot.scenario.yaml * --seat 1 --mirrored --repeat *",
            "*= cooperation scenarios: mine.py:half, mode sample, 20 repeats =*",
            "category    passed  of *",
            "state            0   4 *",
            "convention       0   4 *",
            "total            0   8 *",
            "out/report.json  the report",
            "FAILED T02-pot.scenario.yaml::T02-pot-seat0 - ?* of 20 runs passed*",
        ]
    )
    shown = done.stdout.str()
    assert "Traceback" not in shown
    assert "pytest_items" not in shown

    told = json.loads((kitchens.path / report).read_text())
    assert (told["schema"], told["agent"], told["mode"], told["repeats"]) == (SCHEMA, "mine.py:half", "sample", 20)
    assert [item["id"] for item in told["items"]] == sorted(item["id"] for item in told["items"])
    assert (told["n"], told["passed"], told["by_category"]["state"]["n"]) == (8, 0, 4)
    half = {item["id"]: item for item in told["items"]}["T02-pot-seat1"]
    cases = ElementTree.parse(kitchens.path / junit).iter("testcase")
    (case,) = [case for case in cases if case.get("name") == "T02-pot-seat1"]
    properties = {each.get("name"): each.get("value") for each in case.iter("property")}
    assert properties == {
        "category": "state",
        "rate": str(half["rate"]),
        "wilson_low": str(round(half["wilson_low"], 4)),
        "T*": "None",
        "K": "3",
    }

    (command,) = (line for line in done.outlines if re.match("replay it: .* T02.* --seat 1 --repeat", line))
    words = shlex.split(command.partition("overcooked-bench ")[2])
    assert int(words[-1]) == half["failure"]["repeat"]
    capsys.readouterr()
    codes = [main([*words[:-1], str(repeat)]) for repeat in range(int(words[-1]) + 1)]
    assert codes == [0] * int(words[-1]) + [FAILED], "the first run that is failed is the one that is named"
    assert capsys.readouterr().out.count("`A.pot >= 1` never held") == 1


def test_items_are_chosen_by_words_markers_and_categories(kitchens):
    every = collected(kitchens)
    assert every == sorted(every)
    assert every[:2] == ["T01-yield-seat0", "T01-yield-seat0-mirrored"]
    assert len(every) == 8
    assert collected(kitchens, "-k", "seat1 and not mirrored") == ["T01-yield-seat1", "T02-pot-seat1"]
    assert collected(kitchens, "-k", "easy and seat1") == ["T02-pot-seat1", "T02-pot-seat1-mirrored"]
    assert collected(kitchens, "-m", "ocb_state", "-k", "seat0") == ["T02-pot-seat0", "T02-pot-seat0-mirrored"]
    assert len(collected(kitchens, "--category", "state")) == 4
    assert len(collected(kitchens, "--category", "state,memory", "--category", "convention")) == 8
    assert collected(kitchens, "T02-pot.scenario.yaml::T02-pot-seat1") == ["T02-pot-seat1"]
    marked = run(kitchens, "--markers").stdout.str()
    assert all(f"@pytest.mark.ocb_{category}: " in marked for category in CATEGORIES)


def test_other_tests_are_left_alone(kitchens):
    kitchens.makepyfile(test_other="def test_something():\n    pass\n")
    done = run(kitchens, "--category", "state", "--agent", "mine.py")
    done.assert_outcomes(passed=5, deselected=4)
    done.stdout.no_fnmatch_line("*newly*")


def test_known_failures_and_a_baseline(kitchens):
    first = run(kitchens, "--agent", "stay", "--scenario-report", "stay.json")
    first.assert_outcomes(failed=8)
    (kitchens.path / "known.txt").write_text("# of mine\nT01-yield-*  # does not yield\nT02-pot-seat1\n\n")
    asked = ("--agent", "mine.py", "--known-failures", "known.txt", "--scenario-baseline", "stay.json", "-rxX")
    done = run(kitchens, *asked)
    assert done.ret == FAILED
    done.assert_outcomes(passed=3, xfailed=4, failed=1)
    done.stdout.fnmatch_lines(
        [
            "[[]XPASS(strict)[]] known failure",
            "total            4   8 *",
            "known failures: 4 of 5 failed as expected; they are not counted as passed",
            "newly failing: 0",
            "newly passing: 4",
            "  T02-pot-seat0",
            "XFAIL T01-yield.scenario.yaml::T01-yield-seat0 - does not yield",
        ]
    )
    report = json.loads((kitchens.path / "stay.json").read_text())
    for item in report["items"]:
        item["status"] = "passed" if item["id"].startswith("T01") else "failed"
    report["items"] = [item for item in report["items"] if item["id"] != "T02-pot-seat0"]
    (kitchens.path / "old.json").write_text(json.dumps(report))
    done = run(kitchens, "--agent", "stay", "--scenario-baseline", "old.json", "--tb=no")
    done.stdout.fnmatch_lines(["newly failing: 4", "  T01-yield-seat0", "newly passing: 0", "not in the baseline: 1"])


def test_without_an_agent_there_is_one_line(kitchens):
    done = run(kitchens, "-q")
    assert done.ret == 0
    done.assert_outcomes(skipped=8)
    done.stdout.fnmatch_lines(["8 scenarios skipped: no agent to test: give one with --agent my_agent.py*"])
    shown = run(kitchens, "-q", "-rs").outlines
    assert sum("no agent to test" in line for line in shown) == 1


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["--agent", "gredy"], "did you mean 'greedy'"),
        (["--agent", "missing.py"], "missing.py: no such file"),
        (["--agent", "mine.py:cook"], "mine.py: defines no cook; write `def cook(layout: str, training_seed: int)"),
        (["--agent", "broken.py"], "broken.py, line 1: ZeroDivisionError: division by zero"),
        (["--agent", "dev-v0/{layout}/sp-9"], "sp-9"),
        (["--agent", "stay", "--repeats", "0"], "--repeats 0: give a whole number from 1"),
        (["--agent", "stay", "--agent-warmup", "-1"], "--agent-warmup -1: give a whole number from 0"),
        (["--agent", "stay", "--mode", "bold"], "invalid choice: 'bold'"),
        (["--agent", "stay", "--fuzz", "0"], "--fuzz 0: give a whole number of kitchens from 1"),
        (["--agent", "stay", "--known-failures", "none.txt"], "none.txt"),
        (["--agent", "stay", "--known-failures", "mine.py"], "mine.py:1: 'from overcooked_bench"),
        (["--agent", "stay", "--scenario-baseline", "mine.py"], "mine.py:1: not JSON"),
        (["--agent", "stay", "--scenario-baseline", "other.json"], "other.json: its schema is 7"),
        (["--category", "stat"], "--category stat: choose among state, partner, memory, convention, horizon"),
    ],
)
def test_wrong_use_is_told_at_once(kitchens, arguments, message):
    kitchens.makepyfile(broken="1 / 0")
    (kitchens.path / "other.json").write_text('{"schema": 7}')
    done = run(kitchens, *arguments)
    assert done.ret == USAGE
    assert message in done.stderr.str()
    assert "Traceback" not in done.stderr.str() + done.stdout.str()


CLUMSY = """
class Clumsy:
    observation = "state"

    def reset(self, layout, seats, seeds):
        pass

    def act(self, states):
        if any(chef.holding == "dish" for state in states for chef in state.chefs):
            raise KeyError("no idea")
        return [5] * len(states)

def make_agent(layout, training_seed):
    return Clumsy()
"""


def test_faults_are_told_without_a_traceback_and_stay_with_their_scenarios(kitchens):
    kitchens.makepyfile(clumsy=CLUMSY)
    write(
        kitchens,
        B_has_a_dish=edited(POT, id="T04-dish", B="{facing: down, holds: dish, does: frozen}"),
        nobody_can=edited(POT, id="T05-impossible", budget="", never="dist(A, B) >= 0"),
    )
    done = run(kitchens, "--agent", "clumsy.py", "-k", "seat0 and not mirrored and not T01")
    done.assert_outcomes(passed=1, failed=2, deselected=13)
    done.stdout.fnmatch_lines(
        [
            "T04-dish-seat0, step 0: act() raised KeyError: 'no idea'",
            "*T05-impossible cannot be solved from seat0*",
            "state          1   3 *",
            "FAILED T04-dish.scenario.yaml::T04-dish-seat0 - T04-dish-seat0, step 0: act()*",
        ]
    )
    assert "Traceback" not in done.stdout.str()


def test_what_cannot_be_read_is_told_with_its_line(kitchens):
    write(kitchens, typo=edited(POT, id="T06-typo", pts="{1: ready}"))
    done = run(kitchens, "T06-typo.scenario.yaml")
    done.stdout.fnmatch_lines(["*T06-typo.scenario.yaml:14: unknown key `pts`; did you mean 'pots'?*"])
    assert "Traceback" not in done.stdout.str()
    kitchens.mkdir("again").joinpath("T02-pot.scenario.yaml").write_text(edited(POT, id="T02-pot"))
    done = run(kitchens, "T02-pot.scenario.yaml", "again")
    assert done.ret == USAGE
    assert "the scenario T02-pot-seat0 is in" in done.stderr.str()


def test_a_module_binds_scenarios_and_a_pair_is_one_item(kitchens):
    for half in ("a", "b"):
        write(kitchens, half=edited(POT, id=f"T08-{half}", pair="T08-both"))
    kitchens.makepyfile(
        test_mine="""
        from overcooked_bench.scenarios.plugin.hooks import Scenarios

        test_pair = Scenarios(["T08-a.scenario.yaml"])
        """
    )
    assert collected(kitchens, "test_mine.py") == ["T08-both-pair"]
    assert collected(kitchens, "-k", "T08", "T08-a.scenario.yaml", "T08-b.scenario.yaml") == ["T08-both-pair"]
    run(kitchens, "test_mine.py", "--agent", "mine.py").assert_outcomes(passed=1)
    kitchens.makepyfile(test_mine=(kitchens.path / "test_mine.py").read_text().replace("T08-a", "T09"))
    done = run(kitchens, "test_mine.py")
    done.stdout.fnmatch_lines(["*T09.scenario.yaml: cannot be read*"])


@pytest.mark.slow
def test_an_isolated_agent_fails_the_same_scenarios(kitchens):
    level = isolation_of("strong").level
    isolated = ["--agent", "mine.py", "--isolate=strict", "--repeats", "2"]
    done = run(kitchens, *isolated)
    done.assert_outcomes(passed=4, failed=4)
    done.stdout.fnmatch_lines([f"scenarios: mine.py, mode sample, 2 repeats, isolation {level}"])


@pytest.mark.slow
@pytest.mark.usefixtures("networks")
def test_an_agent_that_does_not_know_a_kitchen_has_not_attempted_it(kitchens):
    done = run(kitchens, "--agent", "dev-v0/cramped_room/sp-0", "--mode", "greedy", "--repeats", "2", "-k", "seat0")
    done.stdout.fnmatch_lines(
        [
            "T01-yield-seat0: not attempted: dev-v0/cramped_room/sp-0 was trained on 'cramped_room' and cannot play*",
            "convention       0   2 *    2",
            "adapted: 1 mirrored kitchens were shown mirrored back",
        ]
    )


@pytest.mark.slow
def test_drawn_kitchens_are_shrunk_to_the_smallest_that_is_failed(kitchens):
    chosen = ("--fuzz", "5", "-k", "fuzz and T02")
    assert collected(kitchens, *chosen) == ["T02-fuzz"]
    done = run(kitchens, "--agent", "mine.py", *chosen)
    done.assert_outcomes(failed=1, deselected=9)
    shown = done.stdout.str()
    smallest = shown.partition("the smallest kitchen, as a scenario:\n\n")[2].partition("\n\n")[0]
    (kitchens.path / "T02-drawn.scenario.yaml").write_text(smallest.partition("=====")[0])
    assert "pots" not in smallest
    assert "replay it" not in shown
    again = run(kitchens, "--agent", "mine.py", *chosen).stdout.str()
    assert smallest in again
    done = run(kitchens, "--agent", "mine.py", "T02-drawn.scenario.yaml", "-k", "seat0 and not mirrored")
    done.assert_outcomes(failed=1, deselected=3)


def heavy(folder, *arguments):
    """Runs pytest in a process of its own and tells which heavy modules it loaded."""
    program = (
        f"import sys, pytest; code = pytest.main({[*arguments, '-pno:cacheprovider']!r})\n"
        "print('LOADED', int(code), *sorted({name.partition('.')[0] for name in sys.modules}))"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True)
    assert done.stderr == ""
    shown, _, loaded = done.stdout.rpartition("LOADED ")
    code, *names = loaded.split()
    return (
        shown,
        int(code),
        set(names) & {"torch", "numba", "scipy", "matplotlib", "PIL", "stable_baselines3", "joblib"},
    )


def test_the_plugin_is_light_until_there_is_an_agent(tmp_path):
    (tmp_path / "test_other.py").write_text("def test_nothing():\n    pass\n")
    (tmp_path / "T02-pot.scenario.yaml").write_text(edited(POT, id="T02-pot"))
    shown, code, loaded = heavy(tmp_path, "-q", "-Werror", "--strict-markers", "-pno:hypothesispytest")
    assert (code, loaded) == (0, set())
    assert "1 passed, 4 skipped" in shown


@pytest.mark.slow
def test_workers_of_xdist_come_to_the_same(kitchens):
    told = []
    for workers in ([], ["-n2", "--dist=loadgroup"]):
        report = kitchens.path / f"{len(told)}.json"
        done = run(kitchens, "--agent", "mine.py:half", f"--scenario-report={report}", *workers)
        assert done.ret == FAILED
        done.stdout.fnmatch_lines(["*cooperation scenarios: mine.py:half*", "total            0   8 *"])
        told.append(json.loads(report.read_text()))
    assert told[0] == told[1]


@pytest.mark.slow
def test_the_shipped_suite_is_collected_as_a_package(pytester):
    shipped = "overcooked_bench.unit_scenarios"
    found = collected(pytester, "--pyargs", shipped)
    assert found == sorted(found)
    assert "C04-yield-pot-cell-seat1-mirrored" in found
    done = run(pytester, "--pyargs", shipped, "--agent", "stay", "-k", "C04 or P09", "--tb=line")
    done.assert_outcomes(failed=8, deselected=len(found) - 8)
