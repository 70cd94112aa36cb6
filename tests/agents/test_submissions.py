"""A submission is all that it uses of its folder, and what it changes stays its own."""

import os
import shutil
import sys

import numpy as np
import pytest

from overcooked_bench import play_episodes
from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.seated import SeatedFault
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.submissions.content import content, hash_submission
from overcooked_bench.agents.submissions.loading import load_submission

LAYOUT = "cramped_room"
AGENT = """
import os
import sys
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent


class Agent:
    observation = "lossless"

    def reset(self, layout, seats, seeds):
        self.rows = len(seats)

    def act(self, observations):
        {act}
        return np.full(self.rows, 4)


{top}


def make_agent(layout, training_seed):
    {make}
    return Agent()
"""


@pytest.fixture
def submit(tmp_path):
    """Writes a submission's files and returns its path."""

    def write(name="mine.py", top="", make="pass", act="pass", **files):
        for other, text in files.items():
            file = tmp_path / other.replace("__", "/").replace("_dot_", ".")
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(AGENT.format(top=top, make=make, act=act))
        return file

    return write


def play(path):
    agents = find(path).make(LAYOUT, 0), find("stay").make(LAYOUT, 0)
    return play_episodes(LAYOUT, agents=agents, episodes=2, horizon=3)


USES = {
    "import": ("import helper", "helper.py"),
    "late import": ("def late(): import helper", "helper.py"),
    "from": ("from helper import *", "helper.py"),
    "through another": ("import other", "helper.py"),
    "package": ("import parts.deep", "parts/deep.py"),
    "data of a package": ("import parts", "parts/w.bin"),
    "by name": ("(HERE / 'w.txt').read_text()", "w.txt"),
    "never opened by Python": ("path = HERE / 'w.safetensors'", "w.safetensors"),
    "by its ending": ("f'{HERE}/{1}.npz'", "cramped_room.npz"),
    "in a folder": ("HERE / 'weights' / 'x'", "weights/deep/x"),
    "by a path": ("(HERE / 'weights/w').read_text()", "weights/w"),
    "by a dynamic import": ("__import__('importlib').import_module('helper')", "helper.py"),
    "hidden": ("(HERE / '.w').read_text()", ".w"),
}


@pytest.mark.parametrize(("code", "used"), USES.values(), ids=USES.keys())
def test_what_a_single_file_uses_beside_it_is_in_its_hash(submit, tmp_path, code, used):
    submit("other.py", "import helper")
    for name in ("helper.py", "w.txt", "w.safetensors", "cramped_room.npz", "weights/deep/x", "weights/w", ".w"):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    (tmp_path / "parts").mkdir()
    for name in ("__init__.py", "deep.py", "w.bin"):
        (tmp_path / "parts" / name).write_text("")
    submit("helper.py")
    path = submit(top=code)
    before, unrelated = hash_submission(path), tmp_path / "unrelated.csv"
    unrelated.write_text("1")
    (tmp_path / "agent2.py").write_text("x = 1")
    assert hash_submission(path) == before == load_submission(path).sha256
    (tmp_path / used).write_text((tmp_path / used).read_text() + "#")
    assert used in content(path)
    assert hash_submission(path) != before


def test_a_single_file_alone_has_the_hash_of_its_content(submit):
    path = submit(top="import numpy, torch.nn, json, overcooked_bench\nX = 'nothing.npz'")
    assert list(content(path)) == ["mine.py"]


FOLDER_USES = ["w.txt", ".w/a", "scores/a", "__pycache__/a", "data/.hidden/x.bin", "x.pyc", "scores/x.json"]


@pytest.mark.parametrize("used", FOLDER_USES)
def test_every_file_of_a_folder_counts(submit, tmp_path, used):
    submit("s/agent.py")
    (tmp_path / "s" / used).parent.mkdir(parents=True, exist_ok=True)
    hashes = []
    for text in ("1", "2"):
        (tmp_path / "s" / used).write_text(text)
        hashes.append(hash_submission(tmp_path / "s"))
    assert len({*hashes}) == 2


LEFT_OUT = [
    *(
        ".git/HEAD",
        ".venv/lib/x.py",
        "__pycache__/agent.cpython-311.pyc",
        "__pycache__/a.nbi",
        "scores/s-dev/score.json",
    ),
    *("out/score.json", "deep/.DS_Store"),
]


@pytest.mark.parametrize("name", LEFT_OUT)
def test_what_is_left_out_of_a_folder_cannot_be_opened(submit, tmp_path, name):
    path = submit("s/agent.py", act=f"(HERE / {name!r}).read_text()").parent
    (path / "out").mkdir()
    (path / "out" / "episodes.sqlite").write_text("")
    before = hash_submission(path)
    (path / name).parent.mkdir(parents=True, exist_ok=True)
    (path / name).write_text("1")
    assert hash_submission(path) == before
    if name.endswith((".pyc", ".nbi")):  # read by Python and numba themselves
        play(path)
    else:
        with pytest.raises(SeatedFault, match=f"opens {name}, which is not part of its hash"):
            play(path)


SECRETLY = "open(HERE / ''.join(['w', 'eights'])).read()"


@pytest.mark.parametrize("swallowed", [False, True])
def test_a_single_file_opens_nothing_that_is_not_in_its_hash(submit, tmp_path, swallowed):
    (tmp_path / "weights").write_text("1")
    code = f"\n    try: {SECRETLY}\n    except Exception: pass" if swallowed else SECRETLY
    with pytest.raises(AgentError, match="opens weights, which is not part of its hash: name the file"):
        load_submission(submit(top=code.replace("\n    ", "\n")))
    with pytest.raises(AgentError, match="opens weights"):
        load_submission(submit(make=code)).make_agent(LAYOUT, 0)
    with pytest.raises(SeatedFault, match="opens weights"):
        play(submit(act=code.replace("\n", "\n    ")))


def test_what_was_changed_after_it_was_hashed_is_not_opened(submit, tmp_path):
    (tmp_path / "w.txt").write_text("1")
    submission = load_submission(submit(make="(HERE / 'w.txt').read_text()"))
    submission.make_agent(LAYOUT, 0)
    (tmp_path / "w.txt").write_text("22")
    with pytest.raises(AgentError, match=r"w\.txt was changed after it was hashed"):
        submission.make_agent(LAYOUT, 0)


def test_a_submission_may_write_and_read_elsewhere_and_miss_files(submit, tmp_path):
    elsewhere = tmp_path.parent / "elsewhere.txt"
    elsewhere.write_text("")
    act = f"Path(HERE / 'log').write_text('x'); Path({str(elsewhere)!r}).read_text(); (HERE / 'no').exists()"
    play(submit("s/agent.py", act=act).parent)
    assert (tmp_path / "s" / "log").read_text() == "x"


def test_linked_folders_count_and_circles_end(submit, tmp_path):
    path = submit("s/agent.py", act="(HERE / 'weights' / 'w').read_text()").parent
    (tmp_path / "far").mkdir()
    (tmp_path / "far" / "w").write_text("1")
    (path / "weights").symlink_to(tmp_path / "far")
    (tmp_path / "far" / "back").symlink_to(path)
    play(path)
    before = hash_submission(path)
    (tmp_path / "far" / "w").write_text("2")
    assert hash_submission(path) != before


def test_a_checkout_and_an_environment_in_the_folder_are_no_part_of_it(submit, tmp_path, monkeypatch):
    path = submit("s/agent.py", act="(HERE / 'env' / 'lib.py').read_text()").parent
    (path / "env").mkdir()
    before = hash_submission(path)
    (path / "env" / "lib.py").write_text("")
    assert hash_submission(path) != before
    monkeypatch.setattr(sys, "prefix", str(path / "env"))
    assert hash_submission(path) == before
    play(path)


@pytest.mark.parametrize("when", ["top", "make", "act"])
@pytest.mark.parametrize(
    "code",
    [
        "os.chdir('/')",
        "__import__('torch').set_default_dtype(__import__('torch').float64)",
        "__import__('torch').set_grad_enabled(False)",
        "__import__('torch').set_default_device('meta')",
        "__import__('torch').set_num_threads(3)",
        "np.seterr(all='raise')",
    ],
)
def test_settings_of_the_process_stay_as_they_were(submit, tmp_path, monkeypatch, code, when):
    import torch

    def settings():
        numbers = torch.get_default_dtype(), str(torch.get_default_device()), torch.get_num_threads()
        return os.getcwd(), *numbers, torch.is_grad_enabled(), np.geterr()

    monkeypatch.chdir(tmp_path)
    before = settings()
    play(submit(**{when: code}))
    assert settings() == before


def test_a_submission_finds_its_own_settings_again(submit, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s" / "data").mkdir(parents=True)
    (tmp_path / "s" / "data" / "w.txt").write_text("")
    top = "os.chdir(HERE / 'data')\nnp.seterr(divide='raise')"
    act = "Path('w.txt').read_text(); assert np.geterr()['divide'] == 'raise'"
    play(submit("s/agent.py", top=top, make=act, act=act).parent)


@pytest.mark.parametrize(
    "code",
    [
        "raise type('Unsaid', (Exception,), {'__str__': lambda self: 1 / 0})()",
        "raise type('Ends', (BaseException,), {})('now')",
        "raise ValueError('\\x1b[2J' + 'x' * 700_000)",
    ],
)
def test_what_a_submission_raises_is_one_line_that_can_be_printed(submit, code):
    for where in ("top", "make"):
        with pytest.raises(AgentError, match=r"mine\.py, line \d+: ") as error:
            load_submission(submit(**{where: code})).make_agent(LAYOUT, 0)
        assert str(error.value).isprintable()
        assert len(str(error.value)) < 1500


def test_a_copy_of_a_submission_elsewhere_has_the_same_hash(submit, tmp_path):
    submit("s/agent.py", **{"s__w_dot_txt": "1"})
    shutil.copytree(tmp_path / "s", tmp_path / "t")
    assert hash_submission(tmp_path / "s") == hash_submission(tmp_path / "t")


def test_more_training_seeds_than_anybody_trains_are_refused(submit):
    with pytest.raises(AgentError, match="TRAINING_SEEDS is 200000000; write a whole number from 1 to 1000"):
        load_submission(submit(top="TRAINING_SEEDS = 200_000_000"))
