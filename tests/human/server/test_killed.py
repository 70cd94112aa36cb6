"""The command as a program of its own, killed in the middle of a game."""

import re
import signal
import subprocess
import sys

import pytest

from overcooked_bench.cli import main
from overcooked_bench.human.games import read_games
from overcooked_bench.human.server.serving import Place, ServerError, listening

from .serving import connected


@pytest.mark.slow
def test_a_killed_server_loses_at_most_the_game_in_progress(tmp_path):
    file = tmp_path / "ours.games.jsonl"
    settings = ["--layouts", "cramped_room", "--pace", "5", "--horizon", "40", "--countdown", "0"]
    program = [sys.executable, "-m", "overcooked_bench", "play", *settings, "--games", str(file)]
    with subprocess.Popen(program, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True) as server:
        try:
            assert server.stdout is not None
            port, token = re.fullmatch(r"http://127\.0\.0\.1:(\d+)/\?token=(.+)\n", server.stdout.readline()).groups()
            with connected(int(port), token) as page:
                assert page.play()["kept"] is True
                page.send("begin", layout="cramped_room", seat=0, partner="greedy")
                page.hear("frame")
                server.send_signal(signal.SIGKILL)
        finally:
            server.kill()
    assert [game.steps for game in read_games(file)] == [40]


def test_a_port_that_is_taken_and_an_address_that_is_not_ours_are_refused():
    with listening(Place()) as taken, pytest.raises(ServerError, match="another --host or --port"):
        listening(Place(port=taken.getsockname()[1]))
    with pytest.raises(ServerError, match="another --host or --port"):
        listening(Place(host="203.0.113.1"))


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (["--study", "plan.yaml", "--pace", "100"], "pace is for the plan"),
        (["--study", "plan.yaml", "greedy"], "agents is for the plan"),
        (["--output", "somewhere"], "--output is the folder of a study"),
        (["--layouts", "no_such_room"], "no_such_room"),
        (["--countdown", "-1"], "whole number from 0"),
        (["--games", "ours.json"], "ours.games.jsonl"),
    ],
)
def test_what_does_not_fit_together_is_refused(given, words, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["play", *given]) == 2
    assert words in capsys.readouterr().err
