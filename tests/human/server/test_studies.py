"""A study on a real server: what participants are sent, and what is kept of them."""

import csv
import json
import urllib.request

import pytest

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.cli import main
from overcooked_bench.human.games import read_games
from overcooked_bench.human.server.studies import open_study
from overcooked_bench.human.study.plan import StudyError
from overcooked_bench.human.study.table import as_csv

from .serving import running

PLAN = """\
name: short
layouts: [cramped_room]
conditions: {trained: "dev-v1/{layout}/NAME", planner: greedy}
consent: A study of the example group; ask us@example.org.
pace: 20
horizon: 30
"""
CODE = "00112233445566ff"


@pytest.fixture
def plan(tmp_path):
    file = tmp_path / "plan.yaml"
    file.write_text(PLAN.replace("NAME", Pool.load("dev-v1").agents("cramped_room")[0].name))
    return file


def opened(plan, folder):
    return open_study(plan, folder, "auto", 0.0, None)


def test_a_participant_plays_all_conditions_blinded_and_is_asked_after_each(plan, tmp_path):
    found = opened(plan, tmp_path / "study")
    with running(found.games, found.terms, found.cast.given, found.log) as server, server.page() as page:
        sent = []

        def hear(*kinds):
            while True:
                sent.append(page.hear())
                if sent[-1]["type"] in kinds:
                    return sent[-1]

        page.send("enroll", code=CODE)
        assert "send consent first" in hear("error")["text"]
        page.send("consent", agree=True)
        page.send("begin", layout="cramped_room", seat=0, partner="stay")
        assert "enroll first" in hear("error")["text"]
        page.send("enroll", code=CODE)
        for number in (1, 2):
            assert hear("trial")["number"] == number
            page.send("next")
            assert hear("end")["kept"] is True
            page.send("next")
            assert "not now" in hear("error")["text"]
            page.send("answers", answers={"fluency": 9, "trust": 1})
            assert "1 to 7" in hear("error")["text"]
            page.send("answers", answers={"fluency": 3 + number, "trust": 1})
        assert hear("thanks")["code"] == CODE
    said = json.dumps(sent)
    for secret in ("dev-v1", "trained", "planner", "greedy"):
        assert secret not in said
    games = read_games(found.games)
    assert sorted(game.notes.rpartition(" ")[2] for game in games) == ["planner", "trained"]
    rows = list(csv.DictReader(as_csv(found.log).splitlines()))
    assert [row["fluency"] for row in rows] == ["4", "5"]
    assert {row["complete"] for row in rows} == {"1"}
    assert main(["games", "answers", str(tmp_path / "study")]) == 0
    assert (tmp_path / "study" / "answers.csv").read_text() == as_csv(found.log)


def test_the_page_of_a_study_names_neither_partners_nor_conditions(plan, tmp_path):
    found = opened(plan, tmp_path / "study")
    with (
        running(found.games, found.terms, found.cast.given, found.log) as server,
        urllib.request.urlopen(server.address, timeout=60) as answer,
    ):
        page = answer.read().decode()
    assert "A study of the example group" in page
    for secret in ("dev-v1", "trained", "planner"):
        assert secret not in page


def test_a_closed_page_loses_no_place_and_a_second_tab_is_refused(plan, tmp_path):
    found = opened(plan, tmp_path / "study")
    with running(found.games, found.terms, found.cast.given, found.log) as server:
        with server.page() as page:
            page.send("consent", agree=True)
            page.send("enroll", code=CODE)
            page.hear("trial")
            with server.page() as second:
                second.send("consent", agree=True)
                second.send("enroll", code=CODE)
                assert "another tab" in second.hear("error")["text"]
            page.send("next")
            page.hear("frame")
        with server.page() as page:
            page.send("consent", agree=True)
            for _ in range(100):  # until the server has noticed that the first page is closed
                page.send("enroll", code=CODE)
                if page.hear("trial", "error")["type"] == "trial":
                    break
            page.send("next")
            assert page.hear("end")["kept"] is True
    assert len(read_games(found.games)) == 1


def test_partners_that_do_not_fit_are_named_before_anybody_plays(plan, tmp_path):
    plan.write_text(plan.read_text().replace("[cramped_room]", "[cramped_room, bottleneck]"))
    with pytest.raises(StudyError, match=r"conditions, trained: dev-v1/bottleneck/.* cannot play on bottleneck"):
        opened(plan, tmp_path / "study")


@pytest.mark.slow
def test_a_participant_goes_through_a_study_by_keyboard(visited, plan, tmp_path):
    found = opened(plan, tmp_path / "study")
    with running(found.games, found.terms, found.cast.given, found.log) as server:
        page = visited(server.address)
        assert "us@example.org" in page.inner_text("#about")
        assert not page.is_visible("#refuse")
        page.click("#agree")
        for _ in range(2):
            page.wait_for_selector("#trial:visible")
            page.focus("#next")
            page.keyboard.press("Enter")
            page.wait_for_selector("#questions:visible", timeout=60_000)
            for question in ("fluency", "trust"):
                page.focus(f"input[name={question}][value='1']")
                page.keyboard.press("Space")
                page.keyboard.press("ArrowRight")
            page.keyboard.press("Enter")
        page.wait_for_selector("#thanks:visible")
        code = page.inner_text("#code")
        page.reload()
        page.click("#agree")
        page.wait_for_selector("#thanks:visible")
        assert page.inner_text("#code") == code
    assert [one.answers for one in found.log.participants.values()] == [
        {0: {"fluency": 2, "trust": 2}, 1: {"fluency": 2, "trust": 2}}
    ]
