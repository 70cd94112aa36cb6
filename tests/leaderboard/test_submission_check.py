"""`submission new | check | pack`: from a template to an archive, and every kind of mistake on the way."""

import hashlib
import json
import os
import pickle
import zipfile

import numpy as np
import pytest

from overcooked_bench.agents.submissions.content import hash_submission
from overcooked_bench.cli import main
from overcooked_bench.leaderboard.submission.archive import unpack
from overcooked_bench.leaderboard.submission.check import check_submission, pack
from overcooked_bench.leaderboard.submission.manifest import SubmissionError
from overcooked_bench.leaderboard.submission.template import FEATURES, new_submission
from overcooked_bench.testing import check_submission as check_play
from tests.evaluation.made import protocol_text
from tests.leaderboard.made import COMPLETE, edit, write_submission


@pytest.fixture
def folder(tmp_path):
    return write_submission(tmp_path / "tiny")


def problems(folder):
    return check_submission(folder).problems


def test_a_new_submission_plays_and_only_its_author_is_missing(tmp_path):
    folder = new_submission(tmp_path / "tiny")
    assert [problem.partition(";")[0] for problem in problems(folder)] == [
        "submission.yaml:4: `contact` is ''",
        "submission.yaml:5: `licence` is ''",
        "submission.yaml:21: `pledge` is false",
    ]
    check_play(folder, layouts=["cramped_room"], steps=10)


def test_the_template_knows_the_size_of_its_observation():
    from overcooked_bench.kitchen.observations.features import NUM_FEATURES

    assert FEATURES == NUM_FEATURES


@pytest.mark.parametrize("name", ["tiny", "../x y", "con", "-x", "."])
def test_nothing_is_overwritten_and_names_are_checked(name, folder, monkeypatch):
    monkeypatch.chdir(folder.parent)
    before = hash_submission(folder)
    with pytest.raises(SubmissionError):
        new_submission(name)
    assert hash_submission(folder) == before
    assert [file.name for file in folder.parent.iterdir()] == ["tiny"]


FILES = {
    "weights.pkl": (pickle.dumps({}), "a pickle, which can run any code"),
    "weights.pt": (b"", "a pickle of torch; write the tensors with safetensors"),
    "model.zip": (b"", "overcooked-bench export"),
    "sneaky.json": (pickle.dumps({}), "a pickle, which can run any code"),
    "lib.so": (b"", "compiled code"),
    "notes.txt": (b"\x7fELF", "compiled code"),
    "film.mp4": (b"", "not a kind of file that is accepted"),
    "w.safetensors": (b"12345678{}", "not a safetensors file"),
    "w.npy": (b"x", "not an array of numpy"),
    "w.npz": (b"x", "not a file of numpy.savez"),
    "long.py": (b"#" * (1 << 20) + b"\n", "1,048,577 bytes; at most 1,048,576"),
    "a b.txt": (b"", "not the same on every system"),
    "AGENT.py": (b"", "one name on some systems"),
}


@pytest.mark.parametrize("name", FILES)
def test_a_file_that_cannot_be_accepted_is_named(name, folder):
    data, words = FILES[name]
    (folder / name).write_bytes(data)
    (problem,) = problems(folder)
    assert words in problem
    assert name.lower() in problem.lower()


def test_arrays_of_objects_are_pickles(folder):
    np.save(folder / "w.npy", np.array([None]), allow_pickle=True)
    np.savez(folder / "w.npz", right=np.zeros(3), wrong=np.array([None]))
    assert [problem.partition(";")[0] for problem in problems(folder)] == [
        "w.npy: a pickle, which can run any code when it is read",
        "w.npz: 'wrong.npy': a pickle, which can run any code when it is read",
    ]


def test_a_file_of_arrays_that_unpacks_to_much_more_is_only_read_in_part(folder):
    with zipfile.ZipFile(folder / "w.npz", "w", zipfile.ZIP_DEFLATED) as whole, whole.open("a.npy", "w") as member:
        for _ in range(64):
            member.write(bytes(1 << 20))
    (problem,) = problems(folder)
    assert "not an array of numpy" in problem


def test_links_are_not_followed(folder):
    (folder / "root").symlink_to("/")
    (folder / "w.json").symlink_to("/etc/passwd")
    (folder / "README.md").unlink()
    (folder / "README.md").symlink_to("nowhere")
    assert set(problems(folder)) == {
        f"{name}: a link; put the file itself there" for name in ("README.md", "root", "w.json")
    }
    assert check_submission(folder).sha256 is None


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("TRAINING_SEEDS = 1", "TRAINING_SEEDS = 5", "agent.py:8: TRAINING_SEEDS is 5, and submission.yaml says"),
        ("TRAINING_SEEDS = 1", "TRAINING_SEEDS = 2 - 1", "agent.py:8: TRAINING_SEEDS is not a plain number"),
        ("TRAINING_SEEDS = 1", "TRAINING_SEEDS = True", "agent.py:8: TRAINING_SEEDS is not a plain number"),
        ("TRAINING_SEEDS = 1", "if True:\n    TRAINING_SEEDS = 1", "agent.py:9: sets TRAINING_SEEDS more than once"),
        ("TRAINING_SEEDS = 1", "TRAINING_SEEDS = 1\nTRAINING_SEEDS += 1", "agent.py:9: sets TRAINING_SEEDS more"),
        (
            "def make_agent",
            "1 / 0\ndef make_agents",
            "defines no make_agent; write `def make_agent(layout, training_seed):`",
        ),
        ("import numpy as np", "import numpy as", "agent.py:5: not Python: "),
        ("import numpy as np", "x = " + "(" * 5000, "agent.py:5: not Python: "),
        ("import numpy as np", "x = " + "-" * 50_000 + "1", "agent.py:1: not Python: "),
        ("import numpy as np", "\0", "not Python: "),
    ],
)
def test_agent_py_is_read_but_not_run(old, new, words, folder):
    edit(folder / "agent.py", {old: new})
    (problem,) = problems(folder)
    assert words in problem


def test_several_seeds_are_written_in_both_places(folder):
    edit(folder / "submission.yaml", {"training_seeds: 1": "training_seeds: 5"})
    edit(folder / "agent.py", {"TRAINING_SEEDS = 1": "TRAINING_SEEDS: int = 5"})
    assert problems(folder) == ()
    edit(folder / "agent.py", {"TRAINING_SEEDS: int = 5": ""})
    assert "which means 1; write `TRAINING_SEEDS = 5`" in problems(folder)[0]


def test_everything_is_listed_at_once(folder):
    (folder / "agent.py").unlink()
    (folder / "submission.yaml").write_bytes(b"\xff")
    (folder / "w.pkl").touch()
    found = problems(folder)
    assert len(found) == 3
    for words in ("not a text file in UTF-8", "agent.py: missing", "w.pkl: a pickle"):
        assert any(words in problem for problem in found)


def test_packing_is_deterministic_and_keeps_the_hash(folder, tmp_path):
    checked, first = pack(folder, tmp_path / "one")
    os.utime(folder / "agent.py", (0, 0))
    (folder / "agent.py").chmod(0o777)
    (folder / ".git").mkdir()
    (folder / ".git" / "config").touch()
    (folder / "__pycache__").mkdir()
    (folder / "__pycache__" / "agent.cpython-311.pyc").touch()
    _, second = pack(folder, tmp_path / "two")
    assert first.archive_sha256 == second.archive_sha256
    assert hashlib.sha256((tmp_path / "two" / "tiny.submission.zip").read_bytes()).hexdigest() == first.archive_sha256
    found = check_submission(first.archive)
    assert found.sound
    assert found.sha256 == checked.sha256 == first.sha256
    assert found.archive_sha256 == first.archive_sha256
    unpack(first.archive, tmp_path / "again")
    assert hash_submission(tmp_path / "again") == hash_submission(folder) == first.sha256


def test_nothing_unsound_is_packed_and_no_archive_is_put_into_the_folder(folder, tmp_path):
    (folder / "w.pkl").touch()
    checked, packed = pack(folder, tmp_path / "out")
    assert packed is None
    assert not checked.sound
    assert not (tmp_path / "out").exists()
    with pytest.raises(SubmissionError, match="inside the submission"):
        pack(folder, folder / "out")


@pytest.mark.slow
def test_the_commands_go_from_a_template_to_a_score(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "tiny.yaml").write_text(protocol_text())
    assert main(["submission", "new", "mine"]) == 0
    assert main(["submission", "check", "mine"]) == 1
    assert "mine: 3 things to change; 4 files" in capsys.readouterr().out
    assert main(["submission", "pack", "mine"]) == 1
    assert "nothing was packed" in capsys.readouterr().out
    edit(tmp_path / "mine" / "submission.yaml", COMPLETE)
    assert main(["submission", "check", "mine", "--json"]) == 0
    checked = json.loads(capsys.readouterr().out)
    assert (checked["sound"], checked["manifest"]["licence"], checked["files"]) == (True, "MIT", 4)
    assert main(["submission", "pack", "mine", "--output", "packed", "--json"]) == 0
    packed = json.loads(capsys.readouterr().out)
    assert packed["sha256"] == checked["sha256"]
    assert main(["submission", "unpack", packed["archive"], "copy"]) == 0
    assert main(["submission", "unpack", packed["archive"], "copy"]) == 2
    assert main(["submission", "check", "nowhere"]) == 2
    assert "no such folder or archive" in capsys.readouterr().err
    score = ["score", packed["archive"], "--protocol", "tiny.yaml", "--workers", "1", "--no-scenarios", "--json"]
    assert main(score) == 0
    agent = json.loads(capsys.readouterr().out)["agent"]
    assert (agent["name"], agent["sha256"]) == ("mine", packed["sha256"])
    (tmp_path / "packed" / "mine" / "agent.py").write_text("")
    assert main(score) == 2
    assert "holds other files than" in capsys.readouterr().err
