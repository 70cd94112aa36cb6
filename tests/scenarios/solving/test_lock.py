import json

import pytest

from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.judge import judge
from overcooked_bench.scenarios.language.loading import load_scenario
from overcooked_bench.scenarios.solving.lock import (
    LOCK_FILE,
    budget_for,
    budget_of,
    entry_of,
    known_entry,
    lock_text,
    read_lock,
    situations,
    stale,
    unused,
    write_lock,
)
from tests.scenarios.writing import POT, YIELD, edited, scenario


@pytest.fixture
def folder(tmp_path):
    for name, text in (("T01-yield", YIELD), ("T02-pot", edited(POT, budget="auto"))):
        (tmp_path / f"{name}.scenario.yaml").write_text(text)
    return tmp_path


def scenarios(folder):
    return [load_scenario(file) for file in sorted(folder.glob("*.scenario.yaml"))]


def no_search(*_):
    raise AssertionError("nothing should be searched")


@pytest.mark.parametrize(("steps", "budget"), [(1, 6), (7, 15), (12, 22), (13, 24)])
def test_budgets(steps, budget):
    assert budget_for("state", steps) == budget
    assert budget_for("horizon", steps) == steps + 1


def test_a_lock_holds_shortest_solutions_that_pass(folder):
    lock = write_lock(folder / LOCK_FILE, scenarios(folder))
    assert read_lock(folder / LOCK_FILE) == lock
    for read in scenarios(folder):
        entry = lock.entry(read)
        for key, situation in situations(read).items():
            witness = entry.witnesses[key]
            assert judge(situation, witness.steps, witness.own).reached == witness.steps
        assert entry.steps == max(witness.steps for witness in entry.witnesses.values())
    assert [lock.scenarios[name].steps for name in ("T01-yield", "T02-pot")] == [7, 1]
    assert [budget_of(read) for read in scenarios(folder)] == [15, 6]


def test_only_what_changed_is_searched_again(folder, monkeypatch):
    lock = write_lock(folder / LOCK_FILE, scenarios(folder))
    before = (folder / LOCK_FILE).read_bytes()
    monkeypatch.setattr("overcooked_bench.scenarios.solving.lock.solve_scenario", no_search)
    write_lock(folder / LOCK_FILE, reversed(scenarios(folder)))
    assert (folder / LOCK_FILE).read_bytes() == before
    reworded = edited(POT, budget="auto", why="In other words.")
    (folder / "T02-pot.scenario.yaml").write_text(reworded)
    assert stale(lock, scenarios(folder)) == []
    (folder / "T02-pot.scenario.yaml").write_text(edited(reworded, A="{facing: left, holds: onion}"))
    assert stale(lock, scenarios(folder)) == ["T02-pot"]
    with pytest.raises(AssertionError, match="nothing should be searched"):
        write_lock(folder / LOCK_FILE, scenarios(folder))
    assert (folder / LOCK_FILE).read_bytes() == before


def test_what_is_gone_is_dropped(folder):
    lock = write_lock(folder / LOCK_FILE, scenarios(folder))
    (folder / "T02-pot.scenario.yaml").unlink()
    assert unused(lock, scenarios(folder)) == ["T02-pot"]
    assert list(write_lock(folder / LOCK_FILE, scenarios(folder)).scenarios) == ["T01-yield"]


def test_without_a_lock_a_budget_is_searched_once(monkeypatch):
    read = scenario(POT, budget="auto", A="{facing: down, holds: onion}")
    assert (entry_of(read).steps, budget_of(read)) == (2, 7)
    monkeypatch.setattr("overcooked_bench.scenarios.solving.lock.solve_scenario", no_search)
    assert budget_of(scenario(POT, budget="auto", A="{facing: down, holds: onion}")) == 7
    assert budget_of(scenario(POT, budget="9")) == 9


def test_what_cannot_be_solved_is_told():
    with pytest.raises(ScenarioError, match=r"T02-pot cannot be solved from seat0 in 3 steps"):
        entry_of(scenario(POT, accept="A.serve >= 1"))


DAMAGED = {
    "json": ("{", "damaged"),
    "key": ('{"version": 1, "scenario": {}}', "damaged"),
    "version": ('{"version": 2, "scenarios": {}}', "version 2"),
    "witness": (
        '{"version": 1, "scenarios": {"x": {"definition": "a", "steps": 1, "budget": 6, '
        '"witnesses": {"seat0": {"steps": 1, "actions": "Q"}}}}}',
        "matching regex",
    ),
}


@pytest.mark.parametrize(("text", "message"), DAMAGED.values(), ids=DAMAGED.keys())
def test_a_damaged_lock_is_told(tmp_path, text, message):
    (tmp_path / LOCK_FILE).write_text(text)
    with pytest.raises(ScenarioError, match=message):
        read_lock(tmp_path / LOCK_FILE)


def edit(folder, **changes):
    """Writes the lock of the two scenarios with changes in T02-pot's entry."""
    write_lock(folder / LOCK_FILE, scenarios(folder))
    content = json.loads((folder / LOCK_FILE).read_text())
    content["scenarios"]["T02-pot"] |= changes
    (folder / LOCK_FILE).write_text(json.dumps(content))


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"budget": 10**9}, "Expected `int` <= 200"),
        ({"steps": -1}, "Expected `int` >= 0"),
        ({"witnesses": 1}, "object"),
    ],
    ids=["budget", "steps", "witnesses"],
)
def test_numbers_that_no_lock_has_are_refused(folder, changes, message):
    edit(folder, **changes)
    with pytest.raises(ScenarioError, match=message):
        read_lock(folder / LOCK_FILE)


FALSE = {
    "budget": {"budget": 150},
    "steps": {"steps": 60, "budget": 94},
    "fewer witnesses": {"witnesses": {"seat0": {"steps": 1, "actions": "I"}}},
    "a witness of another length": {
        "witnesses": {key: {"steps": 1, "actions": "II"} for key in situations(scenario(POT))}
    },
    "witnesses that reach nothing": {
        "witnesses": {key: {"steps": 1, "actions": "S"} for key in situations(scenario(POT))}
    },
    "witnesses that go on": {
        **{"steps": 30, "budget": 49},
        "witnesses": {key: {"steps": 30, "actions": "I" + "S" * 29} for key in situations(scenario(POT))},
    },
}


@pytest.mark.parametrize("changes", FALSE.values(), ids=FALSE.keys())
def test_a_budget_that_does_not_follow_is_not_believed(folder, changes):
    edit(folder, **changes)
    read = load_scenario(folder / "T02-pot.scenario.yaml")
    assert known_entry(read) in (None, entry_of(scenario(POT, budget="auto")))
    assert (entry_of(read).steps, budget_of(read)) == (1, 6)


def test_an_empty_lock_is_one(tmp_path):
    empty = read_lock(tmp_path / LOCK_FILE)
    (tmp_path / LOCK_FILE).write_text(lock_text(empty))
    assert read_lock(tmp_path / LOCK_FILE) == empty
