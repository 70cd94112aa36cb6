"""Compiled kernels do what their Python source says, and need no place to write to."""

import os
import shutil
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

from overcooked_bench import Kitchens
from overcooked_bench.kitchen.jit import CheckedFiles
from tests.kitchen import trace as tracing

PACKAGE = Path(find_spec("overcooked_bench").origin).parent


def run(script: str | Path, *arguments: str | Path, **environment: str) -> str:
    """Runs a script in another process with other environment variables; gives what it printed."""
    variables = {key: value for key, value in os.environ.items() if key != "NUMBA_CACHE_DIR"} | environment
    command = [sys.executable, script, *arguments]
    done = subprocess.run(command, env=variables, cwd=Path(script).parent, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def test_plain_python_plays_the_same_games(tmp_path):
    ours, out = tracing.trace(), tmp_path / "trace.npz"
    for key in ("partial_reward", "soup_reward", "truncated", "events", "actions_taken"):
        for cooking in ("auto", "manual"):
            found = [values.any() for name, values in ours.items() if name.endswith(f"{cooking} {key}")]
            assert len(found) == 3
            assert any(found)
    run(tracing.__file__, out, NUMBA_DISABLE_JIT="1")
    with np.load(out) as theirs:
        assert set(theirs) == set(ours)
        for key, values in ours.items():
            np.testing.assert_array_equal(values, theirs[key], err_msg=key)


@pytest.fixture
def sealed(tmp_path) -> tuple[Path, dict[str, str]]:
    """A copy of the package, and a home, where nobody can write: folders that would be written to are files."""
    copy = tmp_path / "site" / "overcooked_bench"
    shutil.copytree(PACKAGE, copy, ignore=shutil.ignore_patterns("__pycache__"))
    for folder in [copy, *(path for path in copy.rglob("*") if path.is_dir())]:
        (folder / "__pycache__").write_text("")
    nowhere = tmp_path / "nowhere"
    nowhere.write_text("")
    homes = {name: str(nowhere / name) for name in ("HOME", "XDG_CACHE_HOME", "LOCALAPPDATA", "NUMBA_CACHE_DIR")}
    return copy, {"PYTHONPATH": str(copy.parent), **homes}


GAME = """
import overcooked_bench

kitchens = overcooked_bench.Kitchens("cramped_room", 1, start="standard")
kitchens.step([[0, 5]])
print(overcooked_bench.__file__)
print(kitchens.state(0).chefs[0])
print(kitchens.observe("lossless").sum())
"""


@pytest.mark.slow
def test_without_a_place_to_write_kitchens_work_and_nothing_is_written(sealed, tmp_path):
    copy, environment = sealed
    before = sorted(copy.rglob("*"))
    script = tmp_path / "game.py"
    script.write_text(GAME)
    ours = Kitchens("cramped_room", 1, start="standard")
    ours.step([[0, 5]])
    expected = [str(copy / "__init__.py"), str(ours.state(0).chefs[0]), str(ours.observe("lossless").sum())]
    assert run(script, **environment).splitlines() == expected
    assert sorted(copy.rglob("*")) == before


KERNEL = """
from overcooked_bench.kitchen.jit import jit


@jit
def grown(number):
    return number + 1


print(grown(4))
"""


def test_compiled_kernels_are_kept_where_numba_is_told_to_and_never_outlive_their_source(tmp_path):
    script, cache = tmp_path / "kernel.py", tmp_path / "cache"

    def kept() -> dict[Path, int]:
        return {path: path.stat().st_mtime_ns for path in cache.rglob("*.nb?")}

    script.write_text(KERNEL)
    assert run(script, NUMBA_CACHE_DIR=str(cache)) == "5\n"
    first = kept()
    assert len(first) == 2
    assert run(script, NUMBA_CACHE_DIR=str(cache)) == "5\n"
    assert kept() == first
    script.write_text(KERNEL.replace("+ 1", "+ 2"))
    assert run(script, NUMBA_CACHE_DIR=str(cache)) == "6\n"
    assert len(kept()) == 4


DAMAGE = {
    "empty": lambda data: b"",
    "cut": lambda data: data[: len(data) // 2],
    "garbage": lambda data: b"garbage" * 100,
    "one bit": lambda data: data[: len(data) // 2] + bytes([data[len(data) // 2] ^ 1]) + data[len(data) // 2 + 1 :],
}


@pytest.mark.parametrize("suffix", ["nbi", "nbc"])
@pytest.mark.parametrize("damage", DAMAGE.values(), ids=DAMAGE)
def test_a_damaged_file_of_compiled_code_counts_as_absent_and_is_replaced(damage, suffix, tmp_path):
    files = CheckedFiles(str(tmp_path), "kernel", "stamp")
    files.save("key", b"code" * 100)
    assert files.load("key") == b"code" * 100
    (file,) = tmp_path.glob(f"*.{suffix}")
    file.write_bytes(damage(file.read_bytes()))
    assert files.load("key") is None
    files.save("key", b"code" * 100)
    assert files.load("key") == b"code" * 100
    assert len(list(tmp_path.iterdir())) == 2
    assert CheckedFiles(str(tmp_path), "kernel", "of another source").load("key") is None


@pytest.mark.slow
def test_kernels_run_whatever_became_of_their_files(tmp_path):
    script, cache = tmp_path / "kernel.py", tmp_path / "cache"
    script.write_text(KERNEL)
    run(script, NUMBA_CACHE_DIR=str(cache))
    (index,), (code,) = cache.rglob("*.nbi"), cache.rglob("*.nbc")
    code.write_bytes(code.read_bytes()[:-100])
    assert run(script, NUMBA_CACHE_DIR=str(cache)) == "5\n"
    index.unlink()
    (index / "in the way").mkdir(parents=True)  # nothing can be saved now
    assert run(script, NUMBA_CACHE_DIR=str(cache)) == "5\n"


SCRIPTED = """
from overcooked_bench import load_agent, play_episodes

for name in ("greedy", "onion_courier", "dish_courier", "random"):
    pair = load_agent(name, "cramped_room"), load_agent("greedy", "cramped_room")
    print(name, *play_episodes("cramped_room", pair, episodes=2, horizon=60).soup_reward)
"""


@pytest.mark.slow
def test_scripted_agents_play_uncompiled_as_compiled(tmp_path):
    script = tmp_path / "scripted.py"
    script.write_text(SCRIPTED)
    plain = run(script, NUMBA_DISABLE_JIT="1")
    assert plain == run(script)
    assert plain.startswith("greedy 20.0 20.0\n")
