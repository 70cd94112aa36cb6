"""Scenario files, lock files, reports and lists of known failures."""

import itertools
import os
from fnmatch import fnmatchcase

import yaml

from overcooked_bench.files import read_text
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.items import items, load_scenarios, shipped_folder
from overcooked_bench.scenarios.language.loading import load_scenario, read_scenario
from overcooked_bench.scenarios.language.writing import scenario_text
from overcooked_bench.scenarios.plugin.bench import read_known
from overcooked_bench.scenarios.shown.comparing import changes, read_report
from overcooked_bench.scenarios.solving.lock import LOCK_FILE, definition, known_entry, write_lock
from tests.fuzz.harness import TRIES, attack, mixed, seeded
from tests.fuzz.mutators import as_json, bytes_of, lines_of, trees_of, written
from tests.scenarios.language.test_loading import RICH
from tests.scenarios.writing import POT, YIELD, edited

TEXTS = [RICH.encode(), *(file.read_bytes() for file in sorted(shipped_folder().glob("*.scenario.yaml"))[::6])]


@TRIES
def test_scenarios(tries, tmp_path):
    file = tmp_path / "scenario.yaml"

    def read(content: bytes) -> None:
        file.write_bytes(content)
        scenario = read_scenario(read_text(file, 1 << 20, raises=ScenarioError), "f")
        for seat, mirrored in itertools.product((0, 1), (False, True)):
            assert scenario.seated(seat, mirrored).first_state(5)
        assert definition(read_scenario(scenario_text(scenario), "g")) == definition(scenario)

    rng = seeded("scenarios")
    trees = as_json(trees_of([yaml.safe_load(text) for text in TEXTS], rng))
    inputs = mixed(rng, bytes_of(TEXTS, rng), lines_of(TEXTS, rng), trees)
    attack("scenario YAML", TEXTS, inputs, read, ScenarioError, tries).check()


@TRIES
def test_locks(tries, tmp_path):
    for name, text in (("T01-yield", YIELD), ("T02-pot", edited(POT, budget="auto"))):
        (tmp_path / f"{name}.scenario.yaml").write_text(text)
    scenarios = [load_scenario(file) for file in sorted(tmp_path.glob("*.yaml"))]
    file = tmp_path / LOCK_FILE
    write_lock(file, scenarios)
    seed, clock = file.read_bytes(), itertools.count()

    def read(content: bytes) -> None:
        file.write_bytes(content)
        os.utime(file, ns=(0, next(clock)))  # the reader remembers a file by the time of its last change
        for scenario in scenarios:
            entry = known_entry(scenario)
            assert entry is None or entry.budget <= 50

    rng = seeded("locks")
    trees = as_json(trees_of([yaml.safe_load(seed)], rng))
    attack("scenarios.lock", [seed], mixed(rng, bytes_of([seed], rng), trees), read, ScenarioError, tries).check()


@TRIES
def test_reports(tries, tmp_path):
    file, chosen = tmp_path / "report.json", [item.id for item in items(load_scenarios(["S01", "P01"]))]
    now = [{"id": name, "status": "passed", "family": "S01", "passes": 1, "scenarios": ["S01"]} for name in chosen]
    seed = {"schema": 1, "items": [dict(item, status=("passed", "failed")[k % 2]) for k, item in enumerate(now)]}

    def read(content: bytes) -> None:
        file.write_bytes(content)
        changes(read_report(file)["items"], now)

    rng = seeded("reports")
    whole = [written(seed).encode()]
    inputs = mixed(rng, bytes_of(whole, rng), as_json(trees_of([seed], rng)))
    attack("scenario report", whole, inputs, read, ScenarioError, tries).check()


@TRIES
def test_known_failures(tries, tmp_path):
    file = tmp_path / "known.txt"
    seeds = [b"# first\nC01-*  # slow\nS01-a-seat0\n", b"[A-Z]0[!1-9]-*-seat?\r\n"]

    def read(content: bytes) -> None:
        file.write_bytes(content)
        for name in read_known(file):
            fnmatchcase("C01-yield-in-the-corridor-seat0-mirrored", name)

    rng = seeded("known failures")
    attack("known failures", seeds, bytes_of(seeds, rng), read, ScenarioError, tries).check()
