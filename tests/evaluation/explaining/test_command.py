"""The command, and the tables that it prints."""

import json
import re
import shutil

import pytest

from overcooked_bench.cli import main
from overcooked_bench.evaluation.shown.explanation import conventions_table, reasons_table
from overcooked_bench.human.games import read_games

pytestmark = pytest.mark.slow


def test_the_command_says_why_and_keeps_what_to_watch(scored, strangers, tmp_path, capsys):
    folder = tmp_path / "score"
    shutil.copytree(scored, folder)
    assert main(["explain", str(folder), "--pool", str(strangers), "--workers", "1"]) == 0
    said = capsys.readouterr().out
    *_, commands = said.partition("explain.json")
    assert max(map(len, said.removesuffix(commands).splitlines())) <= 100
    for words in (
        "clash of conventions: each does well",
        "forced_coordination",
        "clash (onions, dishes)",
    ):
        assert words.lower() in said.lower()
    games = read_games(folder / "moments" / "moments.games.jsonl")  # every one is played again
    layout = json.loads((folder / "explain.json").read_text())["layouts"][0]
    worst, partner = layout["worst"], layout["moments"][layout["worst"][0]["moment"]]["partner"]
    assert len(games) == 4 * len(worst) == 12
    names = [[player.name for player in game.seats] for game in games[:4]]
    assert set(names[0]) == {"dev-v1-forced_coordination-sp-0", partner}
    assert [len(set(pair)) for pair in names] == [2, 1, 1, 1]
    assert [len(game.soups) for game in games[:4]] == [worst[0]["games"][one]["soups"] for one in worst[0]["games"]]
    replay = re.search("overcooked-bench (replay .*)", commands)[1].split()
    assert main(replay) == 0
    assert "100 steps" in capsys.readouterr().out


def test_the_command_prints_what_it_writes(scored, strangers, tmp_path, capsys):
    folder = tmp_path / "score"
    shutil.copytree(scored, folder)
    assert (
        main(
            [
                "explain",
                str(folder),
                "--pool",
                str(strangers),
                "--workers",
                "1",
                "--layouts",
                "forced_coordination",
                "--json",
            ]
        )
        == 0
    )
    assert capsys.readouterr().out == (folder / "explain.json").read_text()


def test_tables_have_a_row_for_each_layout_and_stratum(explained):
    table = reasons_table(explained.explanation)
    assert [str(row[0]) for row in table.rows] == [
        *("forced_coordination", "all layouts", "with scripted", "with self-play"),
    ]
    assert all(len(row) == len(table.columns) for row in table.rows)
    assert len(conventions_table(explained.explanation, least=1).rows) % 2 == 0
