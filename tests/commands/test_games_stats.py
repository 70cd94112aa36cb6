import json

import pytest

from overcooked_bench.cli import main
from overcooked_bench.human.games import write_games
from tests.human.made import agents_games

FILE = "mine.games.jsonl"


@pytest.fixture
def home(tmp_path, monkeypatch):
    """A working directory with games of two pairs on one layout, and of agents on another."""
    monkeypatch.chdir(tmp_path)
    people = agents_games("forced_coordination", number=4, horizon=100, groups=("a", "b"), start="random")
    write_games(FILE, [*agents_games("coordination_ring", horizon=60), *people])
    return tmp_path


def test_stats_are_printed_per_layout_and_drawn(home, capsys):
    assert main(["games", "stats", FILE]) == 0
    said = capsys.readouterr().out
    lines = {line.split()[0]: line.split() for line in reversed(said.splitlines()) if line.strip()}
    assert lines["forced_coordination"][1:4] == ["4", "2", "400"]
    assert lines["coordination_ring"][1:4] == ["1", "-", "60"]
    for words in ("clockwise, %", "handed", "by chef 1", "onion", "95 % over pairs of people"):
        assert words in said, said
    assert max(map(len, said.splitlines())) <= 100
    assert "…" not in said
    assert (home / "mine-stats" / "visits.png").read_bytes().startswith(b"\x89PNG")
    assert [one["layout"] for one in json.loads((home / "mine-stats" / "stats.json").read_text())] == [
        "coordination_ring",
        "forced_coordination",
    ]


def test_stats_of_some_layouts_are_printed_as_json(home, capsys):
    assert main(["games", "stats", FILE, "--layouts", "forced_coordination", "--output", "here", "--json"]) == 0
    said = capsys.readouterr().out
    (found,) = json.loads(said)
    assert (found["layout"], found["games"], found["pairs"], found["clockwise"]) == ("forced_coordination", 4, 2, None)
    assert found["soups"]["low"] is not None
    assert (home / "here" / "stats.json").read_text() == said


def test_games_that_are_not_there_are_wrong_use(home, capsys):
    assert main(["games", "stats", FILE, "--layouts", "cramped_room"]) == 2
    assert (
        "nothing is played on cramped_room; there are coordination_ring, forced_coordination" in capsys.readouterr().err
    )
    write_games(FILE, [])
    assert main(["games", "stats", FILE]) == 2
    assert "no games in it" in capsys.readouterr().err
