import hashlib
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

import overcooked_bench
from overcooked_bench import UnknownLayout, load_agent
from overcooked_bench.agents.agent import Agent
from overcooked_bench.agents.catalogue import catalogue, find
from overcooked_bench.agents.pools.lineage import Origin
from overcooked_bench.agents.pools.manifest import PoolError
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.agents.submissions.checks import AgentError, check_actions, check_agent
from overcooked_bench.agents.submissions.content import hash_submission
from overcooked_bench.agents.submissions.loading import load_submission
from tests.agents.made import write_policy

WAITS = """
import numpy as np

class Waits:
    observation = "lossless"

    def reset(self, layout, seats, seeds):
        self.rows = len(seats)

    def act(self, observations):
        return np.full(self.rows, 4)

def make_agent(layout, training_seed):
    return Waits()
"""


@pytest.fixture
def submit(tmp_path):
    """Writes a submission's file and gives its path."""

    def write(text, name="entry.py"):
        file = tmp_path / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text)
        return file

    return write


def answers(agent, layout, rows=3):
    agent.reset(layout, np.zeros(rows, np.int64), np.arange(rows, dtype=np.uint64))
    kitchens = overcooked_bench.Kitchens(layout, rows)
    kitchens.reset(seed=0)
    return check_actions(agent.act(kitchens.observe(agent.observation)[:, 0]), rows)


def test_every_listed_name_loads():
    for name in catalogue():
        layout = name.split("/")[1] if "/" in name else "cramped_room"
        agent = load_agent(name, layout)
        assert isinstance(agent, Agent)
        check_agent(agent, name)
    assert set(SCRIPTED) <= set(catalogue())


def test_frozen_agents_of_a_pool(pool_folder):
    agent = load_agent(f"{pool_folder}/cramped_room/sp-1", "cramped_room")
    assert answers(agent, "cramped_room").shape == (3,)
    assert load_agent(f"{pool_folder}/cramped_room/sp-1", "cramped_room", mode="greedy").mode == "greedy"
    for layout in ("coordination_ring", "cramped_room-mirrored"):
        with pytest.raises(UnknownLayout, match="was trained on 'cramped_room'"):
            load_agent(f"{pool_folder}/cramped_room/sp-1", layout)
    with pytest.raises(PoolError, match="did you mean 'sp-1'"):
        load_agent(f"{pool_folder}/cramped_room/sp1", "cramped_room")
    with pytest.raises(AgentError, match="is a pool, not an agent"):
        load_agent(pool_folder, "cramped_room")


def test_another_damaged_agent_of_the_pool_is_no_obstacle(pool_folder):
    (pool_folder / "cramped_room" / "sp-0.json").unlink()
    load_agent(f"{pool_folder}/cramped_room/sp-1", "cramped_room")
    with pytest.raises(PoolError, match=r"sp-0\.json: cannot be read \(no such file\)"):
        load_agent(f"{pool_folder}/cramped_room/sp-0", "cramped_room")


def test_policy_files(tmp_path):
    for file in write_policy(tmp_path / "mine"):
        assert answers(load_agent(file, "cramped_room"), "cramped_room").shape == (3,)


def test_a_file_and_a_folder(submit, tmp_path):
    file = submit(WAITS)
    assert answers(load_agent(file, "cramped_room"), "cramped_room").tolist() == [4, 4, 4]
    submit(WAITS, "folder/agent.py")
    assert answers(load_agent(str(tmp_path / "folder"), "cramped_room"), "cramped_room").tolist() == [4, 4, 4]


@pytest.mark.parametrize(
    ("name", "message"),
    [
        ("gredy", "did you mean 'greedy'"),
        ("no-such-thing", "no agent named 'no-such-thing'"),
        ("missing.py", r"missing\.py: no such file"),
        ("missing.safetensors", r"missing\.json: cannot be read \(no such file"),
        ("no/such/pool/cramped_room/sp-0", "no agent named"),
    ],
    ids=["typo", "unknown", "no-file", "no-policy", "no-pool"],
)
def test_unknown_names_are_told(name, message):
    with pytest.raises(ValueError, match=message):
        load_agent(name, "cramped_room")


def test_a_folder_without_agent_py_is_told(tmp_path):
    for call in (lambda: load_agent(tmp_path, "cramped_room"), lambda: load_submission(tmp_path)):
        with pytest.raises(AgentError, match=r"no agent\.py in this folder"):
            call()


def test_what_a_submission_says(submit):
    file = submit(WAITS + "\nTRAINING_SEEDS = 3\n")
    submission = load_submission(file)
    assert (submission.name, submission.path, submission.training_seeds) == ("entry", file, 3)
    assert submission.sha256 == hashlib.sha256(file.read_bytes()).hexdigest()
    assert load_submission(submit(WAITS)).training_seeds == 1
    for seed in (-1, 3):
        with pytest.raises(AgentError, match="means 0 to 2"):
            submission.make_agent("cramped_room", seed)


def test_a_submission_can_say_where_it_comes_from(submit):
    assert find(submit(WAITS)).origin is None
    for lines, origin in (
        ('CODEBASE = "stable-baselines3"', Origin("stable-baselines3")),
        ('CODEBASE = "overcooked-bench"\nPEOPLE = ["2019-00"]', Origin(None, ("2019-00",))),
        ('PEOPLE = ("2019-00",)', Origin("", ("2019-00",))),
    ):
        assert find(submit(f"{WAITS}\n{lines}\n")).origin == origin
    for line in ("CODEBASE = None", 'PEOPLE = "2019-00"', "PEOPLE = [1]"):
        with pytest.raises(AgentError, match=rf"entry\.py: {line.split()[0]} is .*such as"):
            load_submission(submit(f"{WAITS}\n{line}\n"))
    assert find("greedy").origin == Origin("")
    assert find("dev-v0/{layout}/sp-0").origin == Origin(None)


def test_a_function_of_another_name(submit):
    file = submit(WAITS.replace("make_agent", "make_waiter"))
    assert load_submission(file, "make_waiter").make_agent("cramped_room", 0).observation
    with pytest.raises(AgentError, match="defines no make_cook; write `def make_cook"):
        load_submission(file, "make_cook")


@pytest.mark.parametrize("seeds", ["0", "-1", "2.0", "True", "'3'", "None"])
def test_training_seeds_must_be_a_count(submit, seeds):
    with pytest.raises(AgentError, match=r"entry\.py: TRAINING_SEEDS is"):
        load_submission(submit(f"{WAITS}\nTRAINING_SEEDS = {seeds}\n"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("x = 1\ny = 1 / 0\n", r"entry\.py, line 2: ZeroDivisionError: division by zero \(while it was imported\)"),
        ("import nonesuch\n", r"entry\.py, line 1: ModuleNotFoundError: No module named 'nonesuch'"),
        ("x = 1\ndef f(:\n", r"entry\.py, line 2: SyntaxError"),
        ("raise SystemExit(0)\n", r"entry\.py, line 1: SystemExit"),
        ("import json\njson.loads('{')\n", r"entry\.py, line 2: JSONDecodeError"),
        ("x = 1\n", r"entry\.py: defines no make_agent; write `def make_agent"),
        ("make_agent = 3\n", "defines no make_agent"),
    ],
    ids=["error", "import", "syntax", "exit", "in-a-library", "no-make-agent", "not-callable"],
)
def test_broken_submissions_are_told_with_file_and_line(submit, text, message):
    with pytest.raises(AgentError, match=message) as error:
        load_submission(submit(text))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("body", "message"),
    [
        ("raise KeyError('weights')", r"line 2: KeyError: 'weights' \(make_agent\('cramped_room', 0\)\)"),
        ("raise SystemExit", "line 2: SystemExit"),
        ("return None", "None has no method reset and no act"),
        ("return type('Agent', (), {'observation': 'state', 'reset': print, 'act': print})", "is a class"),
        ("return type('Agent', (), {'reset': print, 'act': print})()", "observation is None; choose one of blind,"),
        ("return type('Agent', (), {'observation': 'pixels', 'reset': print, 'act': print})()", "'pixels'"),
    ],
    ids=["raises", "exits", "none", "class", "no-observation", "unknown-observation"],
)
def test_broken_agents_are_told(submit, body, message):
    submission = load_submission(submit(f"def make_agent(layout, training_seed):\n    {body}\n"))
    with pytest.raises(AgentError, match=message) as error:
        submission.make_agent("cramped_room", 0)
    assert "entry.py" in str(error.value)


def test_unknown_layout_passes_through(submit):
    text = (
        "from overcooked_bench import UnknownLayout\ndef make_agent(layout, seed):\n    raise UnknownLayout(layout)\n"
    )
    with pytest.raises(UnknownLayout, match="cramped_room"):
        load_submission(submit(text)).make_agent("cramped_room", 0)


def test_helpers_belong_to_their_submission_alone(submit, tmp_path):
    for k in (1, 2):
        submit(f"from parts.deep import deep\nvalue = {k}\n", f"s{k}/helper.py")
        submit("", f"s{k}/parts/__init__.py")
        submit("deep = 1\n", f"s{k}/parts/deep.py")
        submit(f"late = {k}\n", f"s{k}/late.py")
        agent = "def make_agent(layout, seed):\n    import helper, late\n    made = Waits()\n"
        text = f"import helper\n{WAITS}{agent}    made.values = helper.value, late.late\n    return made\n"
        submit(text, f"s{k}/agent.py")
    before, path = set(sys.modules), list(sys.path)
    first, second = load_submission(tmp_path / "s1"), load_submission(tmp_path / "s2")
    for _ in range(2):
        assert first.make_agent("cramped_room", 0).values == (1, 1)
        assert second.make_agent("cramped_room", 0).values == (2, 2)
    assert sys.path == path
    assert not {"helper", "late", "parts", "parts.deep"} & (set(sys.modules) - before)
    assert not list(tmp_path.rglob("__pycache__"))
    assert first.sha256 != second.sha256


def test_libraries_stay_imported(submit):
    sys.modules.pop("wave", None)
    load_submission(submit("import wave\n" + WAITS))
    assert "wave" in sys.modules


def test_a_helper_is_not_taken_for_a_foreign_module_of_its_name(submit, monkeypatch):
    foreign = ModuleType("helper")
    monkeypatch.setitem(sys.modules, "helper", foreign)
    submit("value = 5\n", "helper.py")
    load_submission(submit("import helper\nassert helper.value == 5\n" + WAITS))
    assert sys.modules["helper"] is foreign


def test_the_library_itself_is_not_loaded_twice(tmp_path):
    """A submission may lie beside an editable checkout."""
    root = Path(overcooked_bench.__file__).parent
    (tmp_path / "overcooked_bench").symlink_to(root)
    (tmp_path / "entry.py").write_text("from overcooked_bench import UnknownLayout\n" + WAITS)
    code = (
        "import sys; sys.path.insert(0, '.'); import overcooked_bench; from overcooked_bench import UnknownLayout\n"
        "from overcooked_bench.agents.submissions.loading import load_submission\n"
        "load_submission('entry.py'); import overcooked_bench.agents.agent as again\n"
        "print(again.UnknownLayout is UnknownLayout)"
    )
    done = subprocess.run([sys.executable, "-Bc", code], capture_output=True, text=True, check=True, cwd=tmp_path)
    assert done.stdout.strip() == "True"


def test_the_hash_of_a_folder(submit, tmp_path):
    submit(WAITS, "one/agent.py")
    submit("weights", "one/data/w.bin")
    before = hash_submission(tmp_path / "one")
    for left_out in ("__pycache__/agent.pyc", ".git/HEAD", "data/.DS_Store", "scores/one-dev/score.json"):
        submit("cache", f"one/{left_out}")
    assert hash_submission(tmp_path / "one") == before
    submit("WEIGHTS", "one/data/w.bin")
    changed = hash_submission(tmp_path / "one")
    (tmp_path / "one" / "data" / "w.bin").rename(tmp_path / "one" / "data" / "v.bin")
    assert len({before, changed, hash_submission(tmp_path / "one")}) == 3


@pytest.mark.parametrize(
    ("actions", "message"),
    [
        ([0, 1], r"the shape \(2,\) for 3 rows"),
        ([[0, 1, 2]], r"the shape \(1, 3\)"),
        (4, r"the shape \(\)"),
        ([0.0, 1.0, 2.0], r"float64 \(row 0: "),
        ([True, False, True], "bool"),
        (None, "shape"),
        ([0, 6, 9], "the action 6 in row 1"),
        ([0, 1, -1], "the action -1 in row 2"),
        ([[0], [1, 2], 3], "no array"),
    ],
    ids=["short", "nested", "number", "floats", "bools", "none", "six", "negative", "ragged"],
)
def test_wrong_actions_are_told(actions, message):
    with pytest.raises(AgentError, match=message) as error:
        check_actions(actions, 3)
    assert str(error.value).startswith("act returned")
    assert "return 3 whole numbers from 0 to 5" in str(error.value)


def test_actions_of_every_whole_type_are_accepted():
    import torch

    for actions in ([0, 5, 3], np.array([0, 5, 3], np.uint8), torch.tensor([0, 5, 3])):
        checked = check_actions(actions, 3)
        assert checked.dtype == np.int64
        assert checked.tolist() == [0, 5, 3]


def test_naming_agents_loads_no_torch():
    code = (
        "import sys, overcooked_bench; from overcooked_bench.agents.catalogue import catalogue; catalogue();"
        "overcooked_bench.load_agent, overcooked_bench.UnknownLayout; print('torch' in sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"
