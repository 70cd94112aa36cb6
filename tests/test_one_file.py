"""A new layout, scenario, protocol or training method is one new file; CONTRIBUTING.md names the test of every kind.

A data file is added to a copy of the folder that it belongs to, and used from there in a new process.
"""

import re
import shutil
import subprocess
import sys
from importlib.resources import files
from pathlib import Path

import pytest

from overcooked_bench import baselines
from overcooked_bench.agents.catalogue import find
from overcooked_bench.baselines.methods import METHODS
from overcooked_bench.cli import main
from tests.baselines.tiny import self_play

ROOT = Path(__file__).parents[1]

IN_PLACE_OF_THE_FOLDER = """
import importlib.util
import sys

spec = importlib.util.spec_from_file_location({package!r}, {folder!r} + "/__init__.py")
sys.modules[spec.name] = importlib.util.module_from_spec(spec)
"""


@pytest.fixture
def with_file(tmp_path):
    """Runs a program for which a package of data files has one more file, and returns what it prints."""

    def run(package: str, file: str, text: str, program: str) -> str:
        folder = tmp_path / package
        shutil.copytree(str(files(package)), folder, ignore=shutil.ignore_patterns("__pycache__"))
        (folder / file).write_text(text)
        start = IN_PLACE_OF_THE_FOLDER.format(package=package, folder=str(folder))
        done = subprocess.run([sys.executable, "-c", start + program], cwd=tmp_path, capture_output=True, text=True)
        assert done.returncode == 0, done.stdout + done.stderr
        return done.stdout

    return run


LAYOUT = """
import gymnasium
from overcooked_bench.cli import main

env = gymnasium.make("overcooked_bench:Overcooked/Galley-v0", partner="greedy")
print(env.reset(seed=0)[0].shape)
env.step(5)
main(["list", "layouts"])
"""


def test_a_layout_is_one_file(with_file):
    grid = "XXXPXXX\nO1   2D\nXXXSXXX\n"
    shape, *listed = with_file("overcooked_bench.kitchen.layouts", "galley.layout", grid, LAYOUT).splitlines()
    assert shape == "(22, 3, 7)"
    assert any("galley" in line for line in listed)


SCENARIO = """
id: X01-one-step-to-serve
category: state
layout: cramped_room
kitchen: |
  XXPXX
  OB  O
  X  AX
  XDXSX
A: {facing: right, holds: soup}
B: {facing: up, does: frozen}
accept: A.serve >= 1
budget: 4
why: A holds a soup in front of the serving tile.
"""


PASSES = """
from overcooked_bench import run_scenarios

items = run_scenarios("greedy", "X01-one-step-to-serve").to_dict()["items"]
print(len(items), {item["status"] for item in items})
"""


def test_a_scenario_is_one_file(with_file):
    passed = with_file("overcooked_bench.unit_scenarios", "X01-one-step-to-serve.scenario.yaml", SCENARIO, PASSES)
    assert passed == "4 {'passed'}\n"


PLAYS = """
from overcooked_bench.cli import main
from overcooked_bench.evaluation.protocol import protocol_names

print("quick" in protocol_names())
main(["score", "stay", "--protocol", "quick", "--no-scenarios", "--workers", "1", "--output", "out"])
"""


def test_a_protocol_is_one_file(with_file):
    text = files("overcooked_bench.protocols").joinpath("dev.yaml").read_text("utf-8")
    for key, value in (("name", "quick"), ("episodes", "1"), ("layouts", "[cramped_room]"), ("horizon", "10")):
        text = re.sub(rf"(?m)^( *{key}:) [^#\n]+", rf"\1 {value} ", text, count=1)
    shown, *scored = with_file("overcooked_bench.protocols", "quick.yaml", text, PLAYS).splitlines()
    assert shown == "True"
    assert any("protocol quick" in line for line in scored)


METHOD = """
from dataclasses import dataclass

from .learning.algorithms import make_learner
from .learning.settings import Settings
from .running.run import make_env, run


@dataclass(frozen=True, kw_only=True)
class Config(Settings):
    twice: bool = False
    \"\"\"Whether to do it twice.\"\"\"


def train(config, place):
    return run(config, "mine", place, lambda seed: make_learner(config, make_env(config, self_play=True), seed))
"""


def test_a_training_method_is_one_file_and_one_row(tmp_path, monkeypatch):
    (tmp_path / "mine.py").write_text(METHOD)
    monkeypatch.setattr(baselines, "__path__", [*baselines.__path__, str(tmp_path)])
    monkeypatch.setitem(METHODS, "mine", "a method of my own")
    assert main(["train", "mine", *self_play("--twice", "--output", str(tmp_path / "run"))[2:]]) == 0
    assert find(str(tmp_path / "run" / "policy.json")).layout == "cramped_room"


KINDS = {
    "layout",
    "scripted agent",
    "observation",
    "training method",
    "scenario",
    "protocol",
    "metric",
    "pool",
    "entry",
    "command",
    "tutorial",
}
ROWS = re.findall(
    r"^\| \[([a-z ]+)\]\(#\S+\) \|.*\| (\S+) \|$", (ROOT / "CONTRIBUTING.md").read_text("utf-8"), re.MULTILINE
)
TESTS = {kind: re.fullmatch(r"`(tests/\S+\.py)::(\w+)`", test) for kind, test in ROWS}


def test_contributing_has_a_row_for_every_kind():
    assert sorted(kind for kind, _ in ROWS) == sorted(KINDS)


@pytest.mark.parametrize("kind", TESTS)
def test_the_test_of_a_kind_exists(kind):
    file, name = TESTS[kind].groups()
    assert re.search(rf"^def {name}\(", (ROOT / file).read_text("utf-8"), re.MULTILINE)
