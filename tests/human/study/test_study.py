"""The order of a study's games, its record, and its table."""

import csv
from collections import Counter
from itertools import pairwise

import msgspec
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from overcooked_bench.human.study.log import FILE, Played, StudyLog
from overcooked_bench.human.study.order import williams
from overcooked_bench.human.study.plan import Study, StudyError, StudyPlan, read_study
from overcooked_bench.human.study.table import COLUMNS, as_csv

LAYOUTS = ("cramped_room", "coordination_ring", "counter_circuit")


def study_of(conditions=3, layouts=1, **more):
    partners = {f"condition-{k}": f"dev-v1/{{layout}}/agent-{k}" for k in range(conditions)}
    plan = StudyPlan(name="a-study", layouts=LAYOUTS[:layouts], conditions=partners, consent="By us.", **more)
    return Study(plan, "0" * 64)


def code_of(number):
    return f"{number:016x}"


def play(log, code, points=20.0):
    trial = log.next_trial(code)
    log.played(Played(code, trial.number, points, 1, 400, 0, "f" * 64))
    return trial


@settings(deadline=None)
@given(st.integers(1, 12))
def test_a_design_balances_positions_and_what_follows_what(n):
    orders = williams(n)
    assert all(sorted(order) == list(range(n)) for order in orders)
    positions = Counter((position, condition) for order in orders for position, condition in enumerate(order))
    assert len(positions) == n * n
    assert len(set(positions.values())) == 1
    follows = Counter(pair for order in orders for pair in pairwise(order))
    assert len(follows) == n * (n - 1)
    assert len(set(follows.values())) <= 1


@settings(deadline=None)
@given(st.integers(1, 5), st.integers(1, 3), st.integers(0, 5))
def test_a_cycle_of_participants_is_balanced(conditions, layouts, seed):
    study = study_of(conditions, layouts, seed=seed)
    trials = [study.trials(participant) for participant in range(study.cycle)]
    assert all(len({(one.layout, one.condition) for one in own}) == len(own) for own in trials)
    for what in (
        lambda one: (one.layout, one.condition, one.seat),
        lambda one: (one.layout, one.condition, one.number % conditions),
        lambda one: (one.layout, one.number // conditions),
    ):
        counted = Counter(what(one) for own in trials for one in own)
        assert len(set(counted.values())) == 1
    assert trials == [study.trials(participant) for participant in range(study.cycle)]


def test_labels_say_nothing_of_conditions_and_differ_between_participants():
    study = study_of(4)
    own = [{one.condition: one.label for one in study.trials(participant)} for participant in range(24)]
    assert all(sorted(labels.values()) == ["Partner A", "Partner B", "Partner C", "Partner D"] for labels in own)
    assert len({tuple(sorted(labels.items())) for labels in own}) > 5


def test_a_participant_goes_on_where_the_server_was_killed(tmp_path):
    study = study_of(2)
    log = StudyLog(tmp_path, study)
    log.enter(code_of(1))
    play(log, code_of(1))
    with (tmp_path / FILE).open("ab") as file:
        file.write(b'{"type": "ans')
    again = StudyLog(tmp_path, study)
    assert again.unanswered(code_of(1)) == 0
    again.answered(code_of(1), {"fluency": 7, "trust": 1})
    assert again.next_trial(code_of(1)).number == 1
    play(again, code_of(1))
    again.answered(code_of(1), {"fluency": 1, "trust": 7})
    assert again.next_trial(code_of(1)) is None
    assert StudyLog(tmp_path, study).participants == again.participants


def test_the_place_of_one_who_has_dropped_out_is_filled_again(tmp_path):
    log = StudyLog(tmp_path, study_of(1))
    assert [log.enter(code_of(number)).number for number in range(3)] == [0, 1, 2]
    play(log, code_of(0))
    for number in range(3):
        log.leave(code_of(number))
    assert log.enter(code_of(7)).number == 1, "the first who finished keeps its number"
    assert log.enter(code_of(1)).number == 1, "who comes back goes on"
    assert log.enter(code_of(8)).number == 2


@pytest.mark.parametrize("answers", [{}, {"fluency": 3}, {"fluency": 0, "trust": 1}, {"fluency": 8, "trust": 1}])
def test_answers_are_those_of_the_questions(tmp_path, answers):
    log = StudyLog(tmp_path, study_of(1))
    log.enter(code_of(0))
    with pytest.raises(StudyError, match="no game"):
        log.answered(code_of(0), {"fluency": 3, "trust": 3})
    play(log, code_of(0))
    with pytest.raises(StudyError, match=r"fluency \(1 to 7\), trust \(1 to 7\)"):
        log.answered(code_of(0), answers)


def test_the_table_has_a_row_for_each_game(tmp_path):
    log = StudyLog(tmp_path, study_of(2))
    for number in range(2):
        log.enter(code_of(number))
    first = [play(log, code_of(1)) for _ in range(2)]
    log.answered(code_of(1), {"fluency": 6, "trust": 2})
    play(log, code_of(0), points=40.0)
    rows = list(csv.DictReader(as_csv(log).splitlines()))
    assert list(rows[0]) == [*COLUMNS, "fluency", "trust"]
    assert [(row["participant"], row["game"], row["points"]) for row in rows] == [
        ("0", "0", "40"),
        ("1", "0", "20"),
        ("1", "1", "20"),
    ]
    assert [row["condition"] for row in rows[1:]] == [trial.condition for trial in first]
    assert [row["fluency"] for row in rows] == ["", "6", ""]
    assert {row["complete"] for row in rows} == {"0"}


def test_a_record_of_another_plan_or_of_nobody_is_refused(tmp_path):
    log = StudyLog(tmp_path, study_of(1))
    log.enter(code_of(0))
    with pytest.raises(StudyError, match="another version of the plan"):
        StudyLog(tmp_path, Study(study_of(1).plan, "1" * 64))
    event = Played(code_of(5), 0, 0.0, 0, 1, 0, "f" * 64)
    (tmp_path / FILE).write_bytes(msgspec.json.encode(event) + b"\n")
    with pytest.raises(StudyError, match=r"study\.jsonl:1: .* not enrolled"):
        StudyLog(tmp_path, study_of(1))


PLAN = """\
name: ring
layouts: [coordination_ring]
conditions: {self-play: "dev-v1/{layout}/sp-0", planner: greedy}
consent: A study of the example group.
"""


def test_a_plan_is_read_from_a_file(tmp_path):
    file = tmp_path / "plan.yaml"
    file.write_text(PLAN)
    study = read_study(file)
    assert {one.partner for one in study.trials(0)} == {"dev-v1/coordination_ring/sp-0", "greedy"}
    assert study.cycle == 4
    assert list(study.plan.questions) == ["fluency", "trust"]


@pytest.mark.parametrize(
    ("before", "after", "words"),
    [
        ("coordination_ring", "a_ring", "choose among"),
        ("consent: A study of the example group.\n", "", "consent"),
        ("name: ring", "name: ../ring", "name"),
        ("name: ring", "name: ring\nseats: left", "seats"),
        ("name: ring", "name: ring\npace: 1", "pace"),
        ("name: ring", "name: ring\nquestions: {fluency: {text: Well, points: 1}}", "points"),
        ("planner: greedy", "a b: greedy", "conditions"),
    ],
)
def test_what_is_wrong_in_a_plan_is_named(tmp_path, before, after, words):
    file = tmp_path / "plan.yaml"
    file.write_text(PLAN.replace(before, after))
    with pytest.raises(StudyError, match=words):
        read_study(file)
