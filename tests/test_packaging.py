"""The package list is the tree; the built wheel holds the tree and nothing else, and works where it is installed."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import entry_points
from pathlib import Path

import pytest

from docs.render_tutorials import script_of, shortened

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
HOMES = PROJECT["tool"]["setuptools"]["package-dir"]
NOT_SHIPPED = {".md"}
"""Suffixes of what explains the tree to its readers and stays there; so does the folder of results."""
PYTHONS = os.environ.get("OVERCOOKED_BENCH_PYTHONS", "").split() or [sys.executable]
"""What the wheel is installed for: versions or paths, as `uv venv --python` takes them; by default the running one."""
NO_NETWORK = re.compile("Request failed|Failed to fetch|Failed to download|network was disabled")


def tree(root: Path = ROOT) -> dict[str, Path]:
    """The files of a checkout that belong to the package, by their path in a wheel."""
    found = {}
    for package, folder in HOMES.items():
        for path in (root / folder).rglob("*"):
            shipped = path.suffix not in NOT_SHIPPED and path.parent.name != "results"
            if path.is_file() and "__pycache__" not in path.parts and shipped:
                found[f"{package.replace('.', '/')}/{path.relative_to(root / folder).as_posix()}"] = path
    return found


def test_the_package_list_is_the_tree():
    listed = PROJECT["tool"]["setuptools"]["packages"]
    in_tree = {name.rpartition("/")[0].replace("/", ".") for name in tree() if name.endswith(".py")}
    assert sorted(listed) == sorted(in_tree)


def test_every_package_says_what_it_is():
    folders = {name.rpartition("/")[0] for name in tree() if name.endswith(".py")}
    assert {f"{folder}/__init__.py" for folder in folders} <= set(tree())


def test_the_command_is_what_it_is_declared_to_be():
    (command,) = entry_points(group="console_scripts", name="overcooked-bench")
    assert command.value == PROJECT["project"]["scripts"]["overcooked-bench"]
    assert callable(command.load())


@pytest.fixture(scope="module")
def wheel(tmp_path_factory) -> Path:
    """A wheel built from an sdist of a copy of the tree, which it lies in, without network."""
    copy = tmp_path_factory.mktemp("tree")
    for name in ("pyproject.toml", "README.md", "LICENSE"):
        shutil.copy(ROOT / name, copy)
    for folder in HOMES.values():
        shutil.copytree(ROOT / folder, copy / folder, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"))
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", copy / "dist", copy]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    (built,) = (copy / "dist").glob("*.whl")
    return built


@pytest.mark.slow
def test_the_wheel_holds_the_tree_and_nothing_else(wheel):
    with zipfile.ZipFile(wheel) as archive:
        names = {name for name in archive.namelist() if not name.endswith("/")}
        tops = {name.partition("/")[0] for name in names}
        described = {name for name in names if ".dist-info/" in name}
        assert len(tops) == 2
        assert tops - {name.partition("/")[0] for name in described} == {"overcooked_bench"}
        copied = tree(wheel.parents[1])
        assert names - described == set(copied)
        for name, path in copied.items():
            assert archive.read(name) == path.read_bytes()


LOOK = """
from importlib.resources import files
import overcooked_bench
from overcooked_bench import Layout
print(overcooked_bench.__file__)
print(sorted(item.name for item in files("overcooked_bench.protocols").iterdir() if item.name.endswith(".yaml")))
print(Layout.load("cramped_room").rows)
"""


@pytest.mark.slow
def test_the_wheel_alone_finds_its_data(wheel, tmp_path):
    with zipfile.ZipFile(wheel) as archive:
        archive.extractall(tmp_path)
    done = subprocess.run([sys.executable, "-c", LOOK], cwd=tmp_path, capture_output=True, text=True)
    protocols = sorted(path.name for path in (wheel.parents[1] / HOMES["overcooked_bench.protocols"]).glob("*.yaml"))
    rows = ("XXPXX", "O   O", "X   X", "XDXSX")
    expected = [tmp_path / "overcooked_bench" / "__init__.py", protocols, rows]
    assert done.stderr == ""
    assert done.stdout.splitlines() == [str(line) for line in expected]


def run(command, folder: Path) -> str:
    """Runs a command in a folder, with nothing of this Python or of these tests around it; returns what it printed."""
    ours = ("PYTHON", "PYTEST", "VIRTUAL_ENV", "UV_PROJECT")
    around = {name: value for name, value in os.environ.items() if not name.startswith(ours)}
    done = subprocess.run([*map(str, command)], cwd=folder, env=around, capture_output=True, text=True)
    assert done.returncode == 0, f"{command} ended with {done.returncode}:\n{done.stdout}{done.stderr}"
    return done.stdout


def installed(wheel: Path, python: str, home: Path) -> Path:
    """Installs the wheel in an empty environment, or skips where that is impossible; returns the folder of programs."""
    uv = shutil.which("uv")
    if uv is None:
        pytest.skip("uv, which makes the environment, is not on PATH")
    made = subprocess.run([uv, "venv", "--python", python, home], cwd=home.parent, capture_output=True, text=True)
    if made.returncode and python != sys.executable:
        pytest.skip(f"Python {python} cannot be had: {made.stderr.strip().partition(chr(10))[0]}")
    assert made.returncode == 0, made.stderr
    what = f"{PROJECT['project']['name']}[test] @ {wheel.as_uri()}"
    to = ["--python", home / "bin" / "python", "--exclude-newer", PROJECT["tool"]["uv"]["exclude-newer"]]
    done = subprocess.run([uv, "pip", "install", *to, what], cwd=home.parent, capture_output=True, text=True)
    if NO_NETWORK.search(done.stderr):
        pytest.skip(f"the packages for Python {python} cannot be fetched")
    assert done.returncode == 0, done.stderr
    return home / "bin"


@pytest.mark.slow
@pytest.mark.parametrize("python", PYTHONS, ids=lambda python: Path(python).name)
def test_the_wheel_works_in_an_empty_environment(python, wheel, tmp_path):
    programs, here = installed(wheel, python, tmp_path / "environment"), tmp_path / "here"
    here.mkdir()
    (here / "tutorial.py").write_text(shortened(script_of("score_sb3")), "utf-8")
    bench, python = programs / "overcooked-bench", programs / "python"
    found = run([python, "-c", "import overcooked_bench; print(overcooked_bench.__file__)"], here)
    assert Path(found.strip()).is_relative_to(programs.parent)
    assert PROJECT["project"]["version"] in run([bench, "--version"], here)
    assert "cramped_room" in run([bench, "score", "greedy", "--layouts", "cramped_room", "--workers", "1"], here)
    assert (here / "scores" / "greedy-v1" / "report.html").is_file()
    scenario = ["overcooked_bench.unit_scenarios", "--agent", "greedy", "-k", "C02", "-q"]
    assert re.search(r"^[1-9]\d* passed", run([python, "-m", "pytest", "--pyargs", *scenario], here), re.MULTILINE)
    assert re.search(r"dev-v0 .*: sound, [1-9]\d* agents played", run([bench, "pool", "verify", "dev-v0"], here))
    assert "cramped_room" in run([python, "tutorial.py"], here)
    assert (here / "my-ppo" / "agent.py").is_file()
