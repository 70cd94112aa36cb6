"""The program as people run it: real processes, small games."""

import argparse
import json
import os
import re
import shlex
import subprocess
import sys
import time
from importlib import import_module
from importlib.metadata import version
from pathlib import Path

import pytest

from overcooked_bench import cli
from overcooked_bench.commands import listing
from tests.evaluation.made import protocol_text, write_agent

OLD = Path(__file__).parent / "data" / "upgrades" / "score-1"
PROGRAM = [sys.executable, "-c", "import sys; from overcooked_bench.cli import main; sys.exit(main())"]


def run(*arguments, folder):
    return subprocess.run([*PROGRAM, *arguments], cwd=folder, capture_output=True, text=True)


@pytest.fixture(scope="module")
def home(tmp_path_factory):
    """A working directory with a protocol, a good submission and a bad one."""
    home = tmp_path_factory.mktemp("home")
    (home / "tiny.yaml").write_text(protocol_text())
    write_agent(home / "mine.py")
    write_agent(home / "bad.py", act="return np.full(n, 7)")
    return home


@pytest.fixture(scope="module")
def scored(home):
    return run("score", "mine.py", "--protocol", "tiny.yaml", "--workers", "1", "--explain", folder=home)


@pytest.mark.slow
def test_score_prints_a_table_and_writes_a_folder(scored, home):
    assert (scored.returncode, scored.stderr) == (0, "")
    for words in ("cramped_room", "worst partner", "floor", "nothing about retraining", "scores/mine-tiny/report.html"):
        assert words in scored.stdout
    for category in ("state", "partner", "memory", "convention", "horizon", "total"):
        assert re.search(rf"\n{category} +[\d.]+ +\d+ ", scored.stdout)
    assert "\x1b" not in scored.stdout
    written = {file.name for file in (home / "scores" / "mine-tiny").iterdir()}
    assert written == {"score.json", "episodes.sqlite", "report.html", "curve.png", "scenarios.json"}


@pytest.mark.slow
def test_score_again_as_json(scored, home):
    again = run(
        "score", "mine.py", "--protocol", "tiny.yaml", "--workers", "1", "--json", "--no-scenarios", folder=home
    )
    assert again.returncode == 0
    told = json.loads(again.stdout)
    assert (told["agent"]["name"], told["scenarios"]) == ("mine", None)


@pytest.mark.slow
def test_replay_shows_and_writes(scored, home):
    done = run("replay", "scores/mine-tiny", "--partner", "greedy", "--seat", "1", folder=home)
    assert (done.returncode, done.stderr) == (0, "")
    assert "mine on seat 1 with greedy" in done.stdout
    assert "step 40" in done.stdout
    done = run("replay", "scores/mine-tiny", "--worst", "--gif", "worst.gif", "--every", "4", folder=home)
    assert (done.returncode, done.stderr) == (0, "")
    assert (home / "worst.gif").read_bytes().startswith(b"GIF89a")
    for pace, words in (("--fps", "fps=0.0"), ("--every", "every=0")):
        done = run("replay", "scores/mine-tiny", pace, "0", folder=home)
        assert (done.returncode, done.stdout.count("\n")) == (2, 1)
        assert words in done.stderr
        assert "Traceback" not in done.stderr


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["score", "gredy"], 2, "did you mean 'greedy'"),
        (["score", "missing.py"], 2, "no such file"),
        (["score", "greedy", "--layouts", "cramped_rom"], 2, "does not play cramped_rom"),
        (["score", "greedy", "--pool", "nowhere"], 2, "no pool named 'nowhere'"),
        (["score", "greedy", "--engine", "abacus"], 2, "no engine named 'abacus'"),
        (["score", "greedy", "--workers", "0"], 2, "give a whole number from 1"),
        (["replay", "nowhere"], 2, "no such file"),
        (["score", "greedy", "--layouts", ","], 2, "no name given"),
        (["score", "greedy", "--act-timeout", "0"], 2, "give a number above 0"),
        (["score"], 2, "required: AGENT; overcooked-bench score --help"),
        (["crossplay", "nowhere"], 2, "no pool named 'nowhere'"),
        (["list", "dogs"], 2, "invalid choice: 'dogs'"),
        (["train"], 2, "required: METHOD, ...; overcooked-bench train --help"),
        (["train", "by-magic"], 2, "no training method named 'by-magic'"),
        (["dance"], 2, "invalid choice: 'dance'"),
    ],
)
def test_mistakes_end_in_one_message(arguments, code, words, home, monkeypatch, capsys):
    monkeypatch.chdir(home)
    protocol = ["--protocol", "tiny.yaml"] if arguments[0] == "score" else []
    workers = [] if "--workers" in arguments or arguments[0] != "score" else ["--workers", "1"]
    given = cli.main([*arguments, *protocol, *workers])
    said = capsys.readouterr().err
    assert given == code
    assert said.startswith("overcooked-bench: ")
    assert said.count("\n") == 1
    assert words in said
    assert "Traceback" not in said


def test_faults_of_the_agent_are_listed_at_the_end(home, monkeypatch, capsys):
    monkeypatch.chdir(home)
    assert cli.main(["score", "bad.py", "--protocol", "tiny.yaml", "--workers", "1", "--no-scenarios"]) == 1
    said = capsys.readouterr().err
    assert "overcooked-bench: cramped_room, training seed 0, episode 0, partner" in said
    assert said.count("act returned the action 7") == 1, "once for the block of both start states"
    assert "Traceback" not in said


def commands(parser, words=()):
    """All commands and groups of commands, with their parsers."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for name, inner in action.choices.items():
                yield [*words, name], inner
                yield from commands(inner, [*words, name])


@pytest.mark.parametrize("words", [words for words, _ in commands(cli._parser())], ids=" ".join)
def test_every_command_has_help_with_an_example_that_is_understood(words, capsys):
    with pytest.raises(SystemExit) as stop:
        cli.main([*words, "--help"])
    assert stop.value.code == 0
    program, *example = shlex.split(capsys.readouterr().out.partition("example:\n")[2])
    assert program == "overcooked-bench"
    assert example[: len(words)] == words
    assert cli._parser().parse_args(example).command


def test_one_flag_has_one_meaning():
    meant = {}
    for words, parser in commands(cli._parser()):
        for action in parser._actions:
            for flag in action.option_strings:
                meant.setdefault(flag, {}).setdefault((action.metavar, action.nargs), []).append(" ".join(words))
    for flag in ("--layouts", "--workers", "--output", "--json", "--engine", "--seed"):
        assert len(meant[flag]) == 1, meant[flag]


def test_a_command_is_one_file_and_one_row(tmp_path, monkeypatch, capsys):
    (tmp_path / "greet.py").write_text(
        "from overcooked_bench.commands.common import add_command\n\n\n"
        "def add_greet(commands):\n"
        "    parser = add_command(commands, 'greet', _greet, 'greet a cook', 'overcooked-bench greet Ann')\n"
        "    parser.add_argument('name')\n\n\n"
        "def _greet(options):\n"
        "    print(f'hello {options.name}')\n"
        "    return 0\n"
    )
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(cli, "COMMANDS", [*cli.COMMANDS, import_module("greet").add_greet])
    assert cli.main(["greet", "Ann"]) == 0
    assert capsys.readouterr().out == "hello Ann\n"


def test_the_package_runs_as_a_module_and_knows_its_version():
    done = subprocess.run(
        [sys.executable, "-m", "overcooked_bench", "--version"], capture_output=True, text=True, check=True
    )
    assert done.stdout == f"overcooked-bench {version('overcooked-bench')}\n"


def test_ctrl_c_is_no_traceback(monkeypatch, capsys):
    def stopped(options):
        raise KeyboardInterrupt

    monkeypatch.setattr(listing, "_list", stopped)
    assert cli.main(["list"]) == 130
    assert "goes on from there" in capsys.readouterr().err


def test_sigterm_is_ctrl_c(home):
    command = [*PROGRAM, "score", "greedy", "--protocol", "tiny.yaml", "--workers", "2", "--output", "terminated"]
    with subprocess.Popen(command, cwd=home, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        give_up = time.monotonic() + 60
        while not (home / "terminated" / "episodes.sqlite").exists() and time.monotonic() < give_up:
            time.sleep(0.02)
        process.terminate()
        _, said = process.communicate(timeout=60)
    assert process.returncode == 130
    assert "goes on from there" in said
    assert "Traceback" not in said


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_a_terminal_that_lacks_a_character_is_no_traceback(encoding, home):
    environment = {**os.environ, "PYTHONUTF8": "0", "PYTHONIOENCODING": encoding}
    arguments = ["compare", *[str(OLD)] * 2, "--metric", "threshold"]
    done = subprocess.run([*PROGRAM, *arguments], cwd=home, capture_output=True, env=environment)
    assert (done.returncode, done.stderr) == (0, b"")
    assert b">=1" in done.stdout


def test_names_in_brackets_are_printed_as_they_are(home, monkeypatch, capsys):
    monkeypatch.chdir(home)
    for folder in ("[red]out", "[/b]"):
        arguments = ["--protocol", "tiny.yaml", "--workers", "1", "--no-scenarios", "--output", folder]
        assert cli.main(["score", "script:{does: script, actions: [up, interact]}", *arguments]) == 0
        assert f"{folder}/report.html  the report" in capsys.readouterr().out
    assert cli.main(["score", "script:{does: script, actions: [up, interact]}", *arguments]) == 0
    assert "nothing was played: every block was in [/b] already" in capsys.readouterr().out
