"""`import overcooked_bench` and `overcooked-bench --help` stay light, and rooms import only what they may know."""

import ast
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

import overcooked_bench

PACKAGE = Path(overcooked_bench.__file__).parent
BASELINES = PACKAGE.parent / "baselines"
HEAVY = ("numba", "torch", "matplotlib", "scipy", "PIL", "stable_baselines3", "pygame", "tensorboard")

IMPORT = "import overcooked_bench"
HELP = "import contextlib, overcooked_bench.cli as cli\nwith contextlib.suppress(SystemExit):\n    cli.main(['--help'])"


def run(code: str) -> str:
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


COMMANDS = {"import": IMPORT, "help": HELP} | {
    c: HELP.replace("'--help'", f"'{c}', '--help'") for c in ("score", "list", "scenarios")
}


@pytest.mark.parametrize("code", COMMANDS.values(), ids=COMMANDS.keys())
def test_nothing_heavy_is_imported(code):
    shown = run(f"{code}\nimport sys\nprint('LOADED', *sorted(sys.modules))")
    loaded = {name.partition(".")[0] for name in shown.rpartition("LOADED")[2].split()}
    assert "overcooked_bench" in loaded
    assert loaded.isdisjoint(HEAVY)


def test_the_command_answers_as_a_program():
    program = shutil.which("overcooked-bench", path=str(Path(sys.executable).parent))
    assert program is not None
    done = subprocess.run([program, "--help"], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert "score" in done.stdout


@pytest.mark.parametrize("name", overcooked_bench.__all__)
def test_every_public_name_is_there(name):
    assert getattr(overcooked_bench, name) is not None
    assert name in dir(overcooked_bench)


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no attribute 'Kitchn'"):
        overcooked_bench.Kitchn  # noqa: B018


GROUND = {"documents", "errors", "estimate", "files", "processes", "shelf"}
"""Modules that every room may import, and that import nothing of ours but each other."""

# What each room may import, besides itself and the ground.
KNOWS = {
    "kitchen": set(),
    "rendering": {"kitchen"},
    "agents": {"kitchen"},
    "envs": {"kitchen", "agents", "rendering"},
    "scenarios": {"kitchen", "agents", "envs", "rendering"},
    "evaluation": {"kitchen", "agents", "rendering", "scenarios"},
    "leaderboard": {"kitchen", "agents", "rendering", "scenarios", "evaluation"},
    "human": {"kitchen", "agents", "rendering"},
    "commands": {
        *("kitchen", "rendering", "agents", "envs", "scenarios", "evaluation", "leaderboard", "human", "baselines")
    },
}


def imported(path: Path) -> set[str]:
    """Names of all modules that a file imports, wherever in it."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0 or path.is_relative_to(BASELINES), f"{path.name}: write the import in full"
            names.add(node.module or "")
    return names


def test_every_room_has_its_rule():
    rooms = {path.name for path in PACKAGE.iterdir() if (path / "__init__.py").is_file()}
    assert rooms <= set(KNOWS)


@pytest.mark.parametrize("room", KNOWS)
def test_a_room_imports_only_what_it_may_know(room):
    allowed = {room, *KNOWS[room], *GROUND}
    for path in (PACKAGE / room).rglob("*.py"):
        for name in imported(path):
            found = re.match(r"overcooked_bench\.(\w+)", name)
            assert not found or found[1] in allowed, f"{path.relative_to(PACKAGE)} imports {name}"
            assert name.partition(".")[0] not in ("baselines", "protocols", "unit_scenarios", "tests")


@pytest.mark.parametrize("module", sorted(GROUND))
def test_the_ground_imports_no_room(module):
    path = PACKAGE / f"{module}.py"
    if path.is_file():
        ours = {name for name in imported(path) if name.startswith("overcooked_bench")}
        assert ours <= {f"overcooked_bench.{other}" for other in GROUND}


def modules() -> dict[str, Path]:
    """All modules of the package and of the baselines by their full names."""
    found = {f"overcooked_bench.{path.relative_to(PACKAGE).with_suffix('')}": path for path in PACKAGE.rglob("*.py")}
    for path in BASELINES.rglob("*.py"):
        found[f"overcooked_bench.baselines.{path.relative_to(BASELINES).with_suffix('')}"] = path
    return {name.replace("/", ".").removesuffix(".__init__"): path for name, path in found.items()}


def edges(name: str, path: Path, known: dict[str, Path]) -> set[str]:
    """The modules of ours that a module imports, at its top or inside its functions, or names in annotations only."""
    package, found = name if path.name == "__init__.py" else name.rpartition(".")[0], set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            home = ".".join(package.split(".")[: len(package.split(".")) - node.level + 1]) if node.level else ""
            base = ".".join(part for part in (home, node.module) if part)
            found |= {full if (full := f"{base}.{alias.name}") in known else base for alias in node.names}
    return {other for other in found if other in known and other != name}


def test_no_modules_import_each_other_in_a_circle():
    known = modules()
    left = {name: edges(name, path, known) for name, path in known.items() if path.name != "__init__.py"}
    while free := [name for name, needs in left.items() if not needs & left.keys()]:
        for name in free:
            del left[name]
    assert not left, f"in a circle, or above one: {left}"


def test_nothing_but_commands_imports_the_baselines_and_nothing_the_command_line():
    for path in PACKAGE.rglob("*.py"):
        room = path.relative_to(PACKAGE).parts[0]
        for name in imported(path):
            assert room in ("commands", "cli.py") or not name.startswith("overcooked_bench.baselines"), path.name
            assert room == "__main__.py" or not name.startswith("overcooked_bench.cli"), f"{path.name}: {name}"
    for path in BASELINES.rglob("*.py"):
        assert not any(name.startswith("overcooked_bench.cli") for name in imported(path)), path.name


@pytest.mark.parametrize(
    ("room", "library"),
    [
        ("kitchen", "gymnasium"),
        ("kitchen", "torch"),
        ("rendering", "torch"),
        ("rendering", "gymnasium"),
        ("evaluation", "gymnasium"),
    ],
)
def test_a_room_does_without_a_library(room, library):
    for path in (PACKAGE / room).rglob("*.py"):
        assert library not in {name.partition(".")[0] for name in imported(path)}, path.name
