"""The program as people run it: real processes, small games."""

import json
import re
import subprocess
import sys

import pytest

from tests.evaluation.made import protocol_text, write_agent

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
    return run("score", "mine.py", "--protocol", "tiny.yaml", "--workers", "1", folder=home)


@pytest.mark.slow
def test_score_prints_a_table_and_writes_a_folder(scored, home):
    assert (scored.returncode, scored.stderr) == (0, "")
    for words in ("cramped_room", "worst partner", "floor", "nothing about retraining", "scores/mine-tiny/report.html"):
        assert words in scored.stdout
    for category in ("state", "partner", "memory", "convention", "horizon", "total"):
        assert re.search(rf"\n{category} +\d+ +\d+ ", scored.stdout)
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
        (["score", "bad.py"], 1, "cramped_room, training seed 0, episode 0, partner"),
        (["score", "gredy"], 2, "did you mean 'greedy'"),
        (["score", "missing.py"], 2, "no such file"),
        (["score", "greedy", "--layouts", "cramped_rom"], 2, "does not play cramped_rom"),
        (["score", "greedy", "--pool", "nowhere"], 2, "no pool named 'nowhere'"),
        (["score", "greedy", "--engine", "abacus"], 2, "no engine named 'abacus'"),
        (["score", "greedy", "--workers", "0"], 2, "workers is 0"),
        (["replay", "nowhere"], 2, "no such file"),
        (["score", "greedy", "--layouts", ","], 2, "no name given"),
        (["train", "seeds"], 2, "no training method named 'seeds'; there is self-play"),
        (["train"], 2, "overcooked-bench train self-play"),
        (["train", "by-magic"], 2, "no training method named 'by-magic'"),
        (["dance"], 2, "invalid choice: 'dance'"),
    ],
)
def test_mistakes_end_in_one_message(arguments, code, words, home, monkeypatch, capsys):
    from overcooked_bench.cli import main

    monkeypatch.chdir(home)
    protocol = ["--protocol", "tiny.yaml"] if arguments[0] == "score" else []
    workers = [] if "--workers" in arguments or arguments[0] != "score" else ["--workers", "1"]
    try:
        given = main([*arguments, *protocol, *workers])
    except SystemExit as stop:  # argparse
        given = stop.code
    said = capsys.readouterr().err
    assert given == code
    assert words in said
    assert "Traceback" not in said


@pytest.mark.parametrize("command", ["score", "replay", "train", "list"])
def test_every_command_has_help_with_an_example(command, capsys):
    from overcooked_bench.cli import main

    with pytest.raises(SystemExit) as stop:
        main([command, "--help"])
    assert stop.value.code == 0
    assert f"overcooked-bench {command} " in capsys.readouterr().out.partition("example:")[2]


def test_list_names_everything(capsys):
    from overcooked_bench.cli import main

    assert main(["list", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert set(found) == {"layouts", "agents", "protocols", "pools"}
    assert "counter_circuit" in found["layouts"]
    assert "greedy" in found["agents"]
    assert main(["list", "protocols"]) == 0
    assert capsys.readouterr().out == "protocols\n  dev\n"


def test_train_passes_everything_on(monkeypatch):
    import types

    from overcooked_bench import cli

    given = []
    method = types.SimpleNamespace(main=lambda arguments: given.append(arguments) or 3)
    monkeypatch.setattr(cli, "import_module", lambda name: method if name.endswith("baselines.self_play") else None)
    assert cli.main(["train", "self-play", "--layout", "cramped_room", "--help"]) == 3
    assert given == [["--layout", "cramped_room", "--help"]]


def test_ctrl_c_is_no_traceback(monkeypatch, capsys):
    from overcooked_bench import cli

    def stopped(options):
        raise KeyboardInterrupt

    monkeypatch.setattr(cli, "_list", stopped)
    assert cli.main(["list"]) == 130
    assert "goes on from there" in capsys.readouterr().err
