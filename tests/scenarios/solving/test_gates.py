import pytest

from overcooked_bench.scenarios.language.loading import load_scenario
from overcooked_bench.scenarios.shown.table import apart_table, gate_table
from overcooked_bench.scenarios.solving.gates import HONEST, MOST_RANDOM, PLAYERS, check, check_all
from overcooked_bench.scenarios.solving.lock import LOCK_FILE, write_lock
from tests.scenarios.writing import POT, YIELD, edited, scenario


def gates(tested):
    """Puts a scenario to the gates, with few runs of the random player."""
    return check_all([tested], 50)[0]


def test_a_good_scenario_has_no_faults():
    report = check(scenario(YIELD, budget="auto"))
    assert report.mergeable
    assert (report.faults, report.notes) == ((), ())
    assert (report.steps, report.budget, report.stay, report.honest) == (7, 15, 0, 4)
    assert 0 <= report.mean_random <= report.random < 0.03
    assert list(report.players) == list(PLAYERS)
    assert report.players["dish_courier"] == 4
    assert report.players["push"] == 0


def test_what_both_cooks_pass_is_noted():
    easy = {"A": "{facing: left, holds: onion}", "budget": "auto"}
    (note,) = gates(scenario(POT, **easy)).notes
    assert "tags: [sanity]" in note
    assert gates(scenario(POT, **easy, tags="[sanity]")).notes == ()
    (fault,) = gates(scenario(YIELD, tags="[sanity]")).faults
    assert "take it out" in fault


FAULTY = {
    "unsolvable": ({"accept": "A.serve >= 1"}, "cannot be solved"),
    "nothing": ({"accept": "A.holds(onion)", "budget": "5"}, "doing nothing passes"),
    "random": ({"accept": "A.x == 1 or A.x == 3", "budget": "9"}, "random play passes"),
    "loose": ({"budget": "30"}, "the budget is 30 steps for a solution of 1"),
    "memory": ({"category": "memory"}, "one scenario alone never asks for memory"),
    "half": ({"pair": "T02-both"}, "has 1 of its two halves"),
}


@pytest.mark.parametrize(("changes", "message"), FAULTY.values(), ids=FAULTY.keys())
def test_faults_are_found(changes, message):
    report = gates(scenario(POT, **changes))
    assert not report.mergeable
    assert any(message in fault for fault in report.faults), report.faults


def test_what_the_partner_does_alone_is_found():
    aside = edited(POT, B="{facing: right, does: onions}", accept="B.pot >= 1", budget="auto")
    report = gates(scenario(aside.replace("O A O", "O   O").replace("X  BX", "XA BX")))
    assert report.stay == 4
    assert any("doing nothing passes" in fault for fault in report.faults)


def test_what_asks_for_mind_reading_is_found():
    sudden = "{facing: down, does: script, actions: [stay*6, left]}"
    report = gates(scenario(POT, B=sudden, accept="blocked(B) >= 1", budget="8"))
    assert report.steps == 7
    assert report.honest < HONEST * 4
    assert any("knows only B's past" in fault for fault in report.faults)


def test_a_wrong_lock_is_found(tmp_path):
    file = tmp_path / "T01-yield.scenario.yaml"
    file.write_text(edited(YIELD, budget="auto"))
    lock = tmp_path / LOCK_FILE
    write_lock(lock, [load_scenario(file)])
    assert gates(load_scenario(file)).mergeable
    lock.write_text(lock.read_text().replace('"budget": 15', '"budget": 16'))
    assert any(LOCK_FILE in fault for fault in gates(load_scenario(file)).faults)


def test_reports_come_in_order_and_are_laid_out():
    easy = {"A": "{facing: left, holds: onion}", "budget": "auto", "pair": "T02-both", "category": "partner"}
    halves = [
        scenario(POT, id="T02-plain", **easy),
        scenario(edited(POT).replace("XDXSX", "XDoSX"), id="T02-onion", **easy),
    ]
    told = []
    reports = check_all([halves[1], scenario(YIELD), halves[0]], 40, lambda done, of: told.append((done, of)))
    assert [report.scenario.id for report in reports] == ["T02-onion", "T01-yield", "T02-plain"]
    assert all(report.mergeable for report in reports)
    assert told == [(0, 3), (1, 3), (2, 3), (3, 3)]
    lines = "\n".join(gate_table(reports)).splitlines()
    assert [line for line in lines if line.startswith("##")] == ["## partner", "## convention"]
    (row,) = [line for line in lines if line.startswith("| T01-yield ")]
    assert [cell.strip() for cell in row.split(" | ")[1:3]] == ["7", "15"]
    assert max(report.random for report in reports) < MOST_RANDOM


def test_who_is_told_apart():
    items = [*(f"S01-a-seat{seat}{mirror}" for seat in (0, 1) for mirror in ("", "-mirrored")), "M01-b-pair"]
    one = dict.fromkeys(items, True) | {"M01-b-pair": False}
    other = dict.fromkeys(items, False) | {items[0]: True}
    table, *lines = apart_table({"one": one, "other": other})
    assert table.splitlines()[2:] == [
        "| one    |   0 |     3 |",
        "| other  |   3 |     0 |",
        "| passed |   4 |     1 |",
    ]
    assert lines[-3] == "Of 5 items 1 are passed by nobody: M01-b-pair."
    assert lines[-1] == "Of 5 items 1 are passed by everybody: S01-a (1 of 4)."
