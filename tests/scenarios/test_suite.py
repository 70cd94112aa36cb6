"""The scenarios that ship: each passes the checks, and together they are what the README says they are."""

import re
from collections import Counter
from pathlib import Path

import pytest

from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.scenarios import SUFFIX
from overcooked_bench.scenarios.items import load_items, load_scenarios, shipped_folder
from overcooked_bench.scenarios.runner import run_items
from overcooked_bench.scenarios.shown.table import COMMAND, figures
from overcooked_bench.scenarios.solving.gates import MEAN_RANDOM, check_all
from overcooked_bench.scenarios.solving.lock import LOCK_FILE, lock_text, read_lock, stale, unused
from overcooked_bench.scenarios.solving.solver import search_for

TABLE = Path(__file__).parents[2] / "docs" / "scenarios.md"
ROWS = [[cell.strip() for cell in line.split("|")[1:-1]] for line in TABLE.read_text("utf-8").splitlines()]
DOCUMENTED = {row[0]: row for row in ROWS if row and re.fullmatch(r"[A-Z]\d\d-\S+", row[0])}

SCENARIOS = load_scenarios()
GROUPS = {scenario.pair or scenario.id: [] for scenario in SCENARIOS}
for each in SCENARIOS:
    GROUPS[each.pair or each.id].append(each)


@pytest.mark.slow
@pytest.mark.parametrize("group", GROUPS.values(), ids=GROUPS.keys())
def test_scenarios_stand_the_gates(group):
    for report in check_all(group):
        assert report.faults == report.notes == (), report.scenario.id
        assert DOCUMENTED[report.scenario.id] == figures(report)


def test_every_file_of_the_folder_is_four_items_or_half_a_pair():
    files = sorted(shipped_folder().glob("*.yaml"))
    assert [file.name for file in files] == [f"{scenario.id}{SUFFIX}" for scenario in SCENARIOS]
    chosen = load_items()
    single = [item for item in chosen if not item.is_pair]
    alone = {scenario.id for scenario in SCENARIOS if not scenario.pair}
    assert Counter(item.scenarios[0].id for item in single) == dict.fromkeys(alone, 4)
    assert sum(item.is_pair for item in chosen) * 2 == len(SCENARIOS) - len(alone)
    pairs = Counter(item.category == "memory" for item in chosen if item.is_pair)
    assert pairs[True] >= 4
    assert pairs[False] >= 4
    assert {item.category for item in chosen} == {"state", "partner", "memory", "convention", "horizon"}
    assert not [item.id for item in single if item.category == "memory"]
    assert {item.family for item in chosen if item.is_pair and item.category != "memory"} == {"invariance"}


def test_the_lock_file_knows_them_all():
    path = shipped_folder() / LOCK_FILE
    lock = read_lock(path)
    assert (stale(lock, SCENARIOS), unused(lock, SCENARIOS)) == ([], [])
    assert path.read_text("utf-8") == lock_text(lock)


@pytest.mark.slow
def test_random_play_passes_little():
    results = run_items(lambda layout, _: SCRIPTED["random"].factory(layout), load_items(), 30)
    assert sum(result.passes / result.runs for result in results) / len(results) <= MEAN_RANDOM


def test_only_pairs_ask_for_memory():
    """A shortest solution does the same wherever the kitchen looks the same; P16 is passed by pushing on, too."""
    lock = read_lock(shipped_folder() / LOCK_FILE)
    for scenario in SCENARIOS:
        if scenario.pair or scenario.id == "P16-blocker-leaves-late":
            continue
        witness = lock.scenarios[scenario.id].witnesses["seat0"]
        situation, done = scenario.seated(0), {}
        search = search_for(situation)
        row, counts = search.row(situation.state), search.no_counts()
        for t, action in enumerate(witness.own):
            assert done.setdefault(row.tobytes(), action) == action, scenario.id
            row, counts = search.step(row, counts, (action, search.answer(row, situation.behaviour, t)))


def test_the_table_in_the_docs_is_theirs():
    """Its other columns are compared as each scenario is put to the gates."""
    lock = read_lock(shipped_folder() / LOCK_FILE)
    written = {name: (int(row[1]), int(row[2])) for name, row in DOCUMENTED.items()}
    assert written == {name: (entry.steps, entry.budget) for name, entry in lock.scenarios.items()}, f"run {COMMAND}"
