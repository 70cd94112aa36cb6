"""The package list is the tree, and the built wheel holds the tree and nothing else."""

import shutil
import subprocess
import sys
import tomllib
import zipfile
from importlib.metadata import entry_points
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
HOMES = PROJECT["tool"]["setuptools"]["package-dir"]
NOT_SHIPPED = {".md"}
"""Suffixes of what explains the tree to its readers and stays there; so does the folder of results."""


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
