"""Games over the socket: what is kept of them, who may play, and what pages can do to each other."""

import json
from contextlib import closing, suppress
from http.client import HTTPConnection

import pytest
from websockets.exceptions import ConnectionClosed, InvalidStatus

from overcooked_bench.human.game import GamesError
from overcooked_bench.human.games import read_games
from overcooked_bench.human.server.house import Terms
from overcooked_bench.human.server.keeping import LICENCE, GamesFile

from .serving import SHORT, TOKEN, running


@pytest.fixture(scope="module")
def server(tmp_path_factory):
    with running(tmp_path_factory.mktemp("kept") / "ours.games.jsonl") as started:
        yield started


def kept(server):
    return read_games(server.house.kept.path) if server.house.kept.path.exists() else []


def test_a_game_is_kept_if_the_person_agrees_and_replays_to_its_points(server):
    before = len(kept(server))
    with server.page() as page:
        end = page.play(agree=True, seat=1)
    assert end["kept"] is True
    game = kept(server)[before:]
    assert len(game) == 1
    assert (game[0].steps, game[0].layout, game[0].licence) == (30, "cramped_room", LICENCE)
    assert [seat.kind for seat in game[0].seats] == ["agent", "human"]
    assert game[0].seats[0].sha256 is not None
    assert len(game[0].soups) == end["soups"]
    assert set(game[0].actions[1]) == {"S"}


def test_nothing_is_kept_without_consent(server):
    before = kept(server)
    with server.page() as page:
        assert page.play(agree=False)["kept"] is False
    assert kept(server) == before


def test_no_game_begins_before_the_question_is_answered(server):
    with server.page() as page:
        page.send("begin", layout="cramped_room", seat=0, partner="greedy")
        assert "consent" in page.hear("error")["text"]


def test_a_game_that_is_left_is_not_kept(server):
    before = kept(server)
    with server.page() as page:
        page.send("consent", agree=True)
        page.send("begin", layout="cramped_room", seat=0, partner="greedy")
        page.hear("frame")
        page.send("leave")
        page.hear("left")
        assert page.play()["kept"] is True
    assert len(kept(server)) == len(before) + 1


def test_two_people_play_with_each_other(server):
    before = len(kept(server))
    with server.page() as first, server.page() as second:
        first.send("consent", agree=True)
        second.send("consent", agree=True)
        first.send("begin", layout="cramped_room", seat=1)
        second.send("join", room=first.hear("waiting")["room"])
        kitchens = [first.hear("kitchen"), second.hear("kitchen")]
        assert [kitchen["seat"] for kitchen in kitchens] == [1, 0]
        assert kitchens[0]["names"] == ["the other person", "you"]
        first.send("press", action=5)
        assert first.hear("end") == second.hear("end")
    (game,) = kept(server)[before:]
    assert "I" in game.actions[1]
    assert "I" not in game.actions[0]
    assert len(set(game.group.split("-"))) == 2


def test_a_game_of_two_is_kept_only_if_both_agree(server):
    before = kept(server)
    with server.page() as first, server.page() as second:
        first.send("consent", agree=True)
        second.send("consent", agree=False)
        first.send("begin", layout="cramped_room", seat=0)
        second.send("join", room=first.hear("waiting")["room"])
        assert first.hear("kitchen")["kept"] is False
        assert second.hear("end")["kept"] is False
    assert kept(server) == before


def test_who_leaves_ends_the_game_for_the_other_too(server):
    with server.page() as first:
        with server.page() as second:
            first.send("consent", agree=True)
            second.send("consent", agree=True)
            first.send("begin", layout="cramped_room", seat=0)
            second.send("join", room=first.hear("waiting")["room"])
            first.hear("kitchen")
        assert "left" in first.hear("error")["text"]
        assert first.play()["kept"] is True


def test_nobody_joins_a_room_whose_person_has_left(server):
    with server.page() as second:
        with server.page() as first:
            first.send("consent", agree=True)
            first.send("begin", layout="cramped_room", seat=0)
            room = first.hear("waiting")["room"]
            first.send("leave")
            first.send("ping", at=1)
            first.hear("pong")
        second.send("consent", agree=True)
        second.send("join", room=room)
        assert "nobody waits there" in second.hear("error")["text"]


def test_a_watched_game_pauses_steps_and_lets_a_chef_be_taken_over(server):
    before = kept(server)
    with server.page() as page:
        page.send("consent", agree=True)
        page.send("watch", layout="cramped_room", agents=["greedy", "stay"])
        assert page.hear("kitchen")["seat"] is None
        page.send("control", do="pause")
        page.send("ping", at=0)
        page.hear("pong")
        page.send("control", do="step")
        at = page.hear("frame")["frame"]
        page.send("take", seat=1)
        page.send("press", action=0)
        page.send("control", do="step")
        after = page.hear("frame")["frame"]
        assert after[0] == at[0] + 1
        assert after[2][1][2] == 0, "the chef that was taken over faces up"
        page.send("take", seat=None)
        page.send("control", do="resume")
        assert page.hear("end")["kept"] is False
    assert kept(server) == before


@pytest.mark.parametrize(
    ("wanted", "words"),
    [
        ({"layout": "no_such_room"}, "no layout 'no_such_room'"),
        ({"layout": "coordination_ring"}, "there are cramped_room"),
        ({"partner": "/etc/passwd"}, "is not offered"),
        ({"partner": "dev-v1/forced_coordination/sp-0"}, "is not offered"),
    ],
)
def test_only_what_is_offered_can_be_played(server, wanted, words):
    with server.page() as page:
        page.send("consent", agree=True)
        page.send("begin", **{"layout": "cramped_room", "seat": 0, "partner": "greedy", **wanted})
        assert words in page.hear("error")["text"]
        assert page.hear


@pytest.mark.parametrize(
    "text",
    ["", "[]", "{", '{"type": "begin"}', '{"type": "press", "action": 6}', '{"type": "x"}', "[" * 2000, '"\\ud800"'],
)
def test_what_is_no_message_is_answered_and_does_no_harm(server, text):
    with server.page() as page:
        page.connection.send(text)
        assert "not a message" in page.hear("error")["text"]
        assert page.play()["steps"] == 30


@pytest.mark.parametrize("content", ["x" * 3000, b"\x00\x01", "x" * 3_000_000], ids=["long", "bytes", "huge"])
def test_what_is_too_long_or_no_text_closes_this_page_alone(server, content):
    with server.page() as other:
        other.send("consent", agree=True)
        other.send("begin", layout="cramped_room", seat=0, partner="greedy")
        with server.page() as page:
            with suppress(ConnectionClosed):
                page.connection.send(content)
            with pytest.raises(ConnectionClosed):
                page.hear("nothing of the kind")
        assert other.hear("end")["steps"] == 30


@pytest.mark.parametrize(
    "headers",
    [
        {"origin": "http://evil.example"},
        {"origin": None},
        {"token": "another"},
        {"token": ""},
        {"name": "evil.example"},
    ],
    ids=["foreign origin", "no origin", "wrong token", "no token", "foreign name"],
)
def test_strangers_do_not_come_in(server, headers):
    with pytest.raises(InvalidStatus, match="403"), server.page(**headers):
        pass


@pytest.mark.parametrize(
    ("host", "token", "status"),
    [("127.0.0.1", TOKEN, 200), ("localhost", TOKEN, 200), ("evil.example", TOKEN, 403), ("127.0.0.1", "wrong", 403)],
)
def test_the_page_is_for_those_who_know_the_token_under_the_right_name(server, host, token, status):
    with closing(HTTPConnection("127.0.0.1", server.port, timeout=60)) as connection:
        connection.request("GET", f"/?token={token}", headers={"Host": host})
        answer = connection.getresponse()
        assert (answer.status, answer.headers["X-Frame-Options"]) == (status, "DENY")
        assert ("Before you play" in answer.read().decode()) == (status == 200)


def test_an_agent_that_breaks_its_contract_ends_the_game_with_a_message(tmp_path):
    agent = tmp_path / "bad.py"
    agent.write_text(
        "class Bad:\n    observation = 'features'\n    def reset(self, layout, seats, seeds): pass\n"
        "    def act(self, observations): return [9]\n\n\ndef make_agent(layout, training_seed): return Bad()\n"
    )
    with running(given=(str(agent),)) as server, server.page() as page:
        page.send("consent", agree=True)
        page.send("begin", layout="cramped_room", seat=0, partner=str(agent))
        assert "9" in page.hear("error")["text"]
        assert page.play()["steps"] == 30


def test_a_slow_agent_never_holds_up_the_game(tmp_path):
    agent = tmp_path / "slow.py"
    agent.write_text(
        "import time\n\n\nclass Slow:\n    observation = 'features'\n    def reset(self, layout, seats, seeds): pass\n"
        "    def act(self, observations):\n        time.sleep(0.2)\n        return [5]\n\n\n"
        "def make_agent(layout, training_seed): return Slow()\n"
    )
    kept_at = tmp_path / "ours.games.jsonl"
    terms = Terms(("cramped_room",), pace=0.02, horizon=50, countdown=0.0)
    with running(kept_at, terms, (str(agent),)) as server, server.page() as page:
        end = page.play(partner=str(agent))
    assert end["steps"] == 50
    (game,) = read_games(kept_at)
    assert game.actions[1].count("I") <= 10
    assert "too late" in game.notes


def test_an_agent_that_does_not_fit_is_not_offered_and_the_reason_is_shown(tmp_path):
    agent = tmp_path / "picky.py"
    agent.write_text(
        "from overcooked_bench import UnknownLayout\n\n\ndef make_agent(layout, training_seed):\n"
        "    raise UnknownLayout('only large kitchens')\n"
    )
    with running(given=(str(agent),), terms=SHORT) as server:
        offers = server.house.cast.offers("cramped_room")
        assert "only large kitchens" in offers.refused[str(agent)]
        assert not offers.has(str(agent))
        assert offers.has("dev-v1/cramped_room/sp-0") or offers.offered["pool dev-v1"]


def test_a_games_file_is_named_as_one_and_loses_the_line_that_a_killed_server_left_unfinished(tmp_path):
    with pytest.raises(GamesError, match=r"ours\.games\.jsonl"):
        GamesFile(tmp_path / "ours.json")
    file = tmp_path / "ours.games.jsonl"
    with running(file) as server, server.page() as page:
        page.play()
    whole = file.read_bytes()
    file.write_bytes(whole + whole[:40])
    GamesFile(file)
    assert file.read_bytes() == whole
    assert json.loads(whole)["layout"] == "cramped_room"
