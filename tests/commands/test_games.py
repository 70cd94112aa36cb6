"""`overcooked-bench games`, and `replay` of a games file."""

import json
from pathlib import Path

import msgspec
import pytest

from overcooked_bench.cli import main
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.human.games import read_games, write_games
from tests.evaluation.made import protocol_text, score
from tests.human.made import agents_games, random_game


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """A folder with a games file, and one that deviates."""
    home = tmp_path_factory.mktemp("home")
    games = [*agents_games(horizon=60, groups=("2019-03",)), random_game("coordination_ring", steps=9)]
    write_games(home / "some.games.jsonl", games)
    wrong = [json.loads(msgspec.json.encode(game)) for game in games]
    wrong[0]["soups"] = [[2, 0]]
    wrong[1]["actions"][1] = "?" * 9
    (home / "wrong.games.jsonl").write_text("\n".join(map(json.dumps, [*wrong, wrong[0]])))
    return home


@pytest.fixture(scope="module")
def scored(home):
    (home / "tiny.yaml").write_text(protocol_text(layouts=["cramped_room", "forced_coordination"]))
    score("greedy", home / "tiny.yaml", output=home / "scored")


@pytest.fixture(autouse=True)
def inside(home, monkeypatch):
    monkeypatch.chdir(home)


def test_show_prints_a_row_per_game(capsys):
    assert main(["games", "show", "some.games.jsonl"]) == 0
    said = capsys.readouterr().out
    for words in ("cramped_room", "coordination_ring", "a person + a person", "2019-03", "made up", "2 games", " 69 "):
        assert words in said


def test_show_prints_what_games_say_as_json(capsys):
    assert main(["games", "show", "some.games.jsonl", "--json", "--layouts", "coordination_ring"]) == 0
    (facts,) = json.loads(capsys.readouterr().out)
    assert (facts["game"], facts["layout"], facts["steps"]) == (1, "coordination_ring", 9)
    assert facts["seats"][0] == {"kind": "human", "name": "a person", "sha256": None}
    assert "actions" not in facts


def test_a_sound_file_is_verified(capsys):
    assert main(["games", "verify", "some.games.jsonl"]) == 0
    assert sum(len(game.soups) for game in read_games("some.games.jsonl")) == 1
    assert capsys.readouterr().out == "some.games.jsonl: sound; 2 games replayed, 69 steps, 1 soup\n"


def test_a_file_of_another_kind_is_not_recited(home, capsys):
    (home / "no.games.jsonl").write_text("x\n" * 50)
    assert main(["games", "verify", "no.games.jsonl"]) == 1
    said = capsys.readouterr().out.splitlines()
    assert len(said) == 22
    assert said[-2:] == [
        "... and 30 more, which --json lists",
        "no.games.jsonl: not sound, 50 faults; 0 games replayed, 0 steps, 0 soups",
    ]


def test_a_file_that_deviates_is_named_with_line_and_step(capsys):
    assert main(["games", "verify", "wrong.games.jsonl"]) == 1
    said = capsys.readouterr().out.splitlines()
    assert len(said) == 4
    assert said[0].startswith("wrong.games.jsonl:1: step 2, chef 0: the listed soup is not delivered")
    assert said[1].startswith("wrong.games.jsonl:2: step 0: the action '?' of chef 1")
    assert said[2].startswith("wrong.games.jsonl:3: step 2")
    assert main(["games", "verify", "wrong.games.jsonl", "--json"]) == 1
    told = json.loads(capsys.readouterr().out)
    assert (told["sound"], told["games"], len(told["faults"])) == (False, 0, 3)


@pytest.mark.slow
def test_a_score_is_exported_and_its_games_are_those_that_were_played(scored, capsys):
    assert main(["games", "export", "scored"]) == 0
    assert capsys.readouterr().out == f"{Path('scored/episodes.games.jsonl')}  16 games, 640 steps\n"
    games = read_games("scored/episodes.games.jsonl")
    with Store("scored/episodes.sqlite") as store:
        episodes, agent = list(store.episodes()), store.facts["agent"]
    for game, one in zip(games, episodes, strict=True):
        assert (game.layout, game.horizon, game.group, game.notes) == (one.layout, 40, None, one.cell)
        assert (game.joint_actions() == one.joint_actions(40)).all()
        assert game.first_state() == one.first_state
        assert (game.seats[one.seat].name, game.seats[one.seat].sha256) == ("greedy", agent)
        assert (game.seats[1 - one.seat].name, game.seats[1 - one.seat].sha256) == (one.partner, one.partner_sha256)
        assert [sum(seat == k for _, seat in game.soups) for k in (one.seat, 1 - one.seat)] == [
            one.ego_soups,
            one.partner_soups,
        ]
    one = "forced_coordination"
    assert main(["games", "export", "scored/episodes.sqlite", "--layouts", one, "--output", "new/one"]) == 0
    assert read_games("new/one/episodes.games.jsonl") == [game for game in games if game.layout == one]
    assert main(["games", "export", "scored", "--layouts", "bottleneck"]) == 2
    assert "nothing is played on bottleneck; there are cramped_room, forced" in capsys.readouterr().err


def test_a_game_is_replayed_and_written_as_a_gif(capsys):
    assert main(["replay", "some.games.jsonl"]) == 0
    said = capsys.readouterr().out
    assert "game 0, cramped_room: a person on seat 0 with a person, 60 steps" in said
    assert "step 60" in said
    assert main(["replay", "some.games.jsonl", "--game", "1", "--gif", "game.gif", "--every", "4"]) == 0
    assert "game 1, coordination_ring" in capsys.readouterr().out
    assert Path("game.gif").read_bytes().startswith(b"GIF89a")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["games", "show", "none.games.jsonl"], "no such file"),
        (["games", "show", "wrong.games.jsonl"], "wrong.games.jsonl:1: step 2"),
        (
            ["games", "show", "some.games.jsonl", "--layouts", "bottleneck"],
            "nothing is played on bottleneck; there are cram",
        ),
        (["games", "verify", "."], "a folder"),
        (["games", "export", "nowhere"], "no such file"),
        (["replay", "some.games.jsonl", "--game", "2"], "no game 2; it has games 0 to 1"),
        (["replay", "some.games.jsonl", "--training-seed", "0"], "--training-seed chooses among the episodes"),
        (["replay", "scored", "--game", "0"], "--game chooses a game of a games file"),
    ],
)
def test_mistakes_end_in_one_message(arguments, words, capsys):
    assert main(arguments) == 2
    said = capsys.readouterr().err
    assert words in said
    assert said.count("\n") == 1
