"""A submission: a Python file, or a folder with `agent.py`, that defines `make_agent(layout, training_seed)`.

Its code runs in this process, as every Python module's does; nothing of it is unpickled by us.
"""

import hashlib
import sys
import traceback
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import module_from_spec, spec_from_file_location
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import Any, Final

from overcooked_bench.agents.agent import Agent, UnknownLayout
from overcooked_bench.agents.submissions.checks import AgentError, check_agent

ENTRY: Final = "agent.py"
MAKE_AGENT: Final = "make_agent"
_PREFIX: Final = "overcooked_bench_submission_"
_numbers = count()


@dataclass(frozen=True)
class Submission:
    """A submission that was loaded.

    Attributes:
        name: Its file's stem, or its folder's name.
        path: The file or folder.
        training_seeds: How many independent training runs it holds: `make_agent` takes 0 to training_seeds - 1.
        make_agent: `make_agent(layout, training_seed)` gives an agent that keeps the contract as far as can be seen;
            raises UnknownLayout where the submission does, and AgentError for every other fault.
        sha256: Of the file, or of the folder's files with their names, as `hash_submission` gives it; hexadecimal.
    """

    name: str
    path: Path
    training_seeds: int
    make_agent: Callable[[str, int], Agent]
    sha256: str


def load_submission(path: str | Path, function: str = MAKE_AGENT) -> Submission:
    """Loads a submission as a module of its own; modules beside it can be imported by it and by nobody else.

    Args:
        path: A Python file, or a folder with `agent.py`.
        function: What in it makes the agents.

    Raises:
        AgentError: No such file, its code fails, or it does not define what it should; names file and line.
    """
    path, wanted = Path(path).absolute(), f"def {function}(layout: str, training_seed: int) -> Agent"
    file = path / ENTRY if path.is_dir() else path
    if not file.is_file():
        what = f"no {ENTRY} in this folder" if path.is_dir() else "no such file"
        raise AgentError(f"{path}: {what}; a submission is a Python file, or a folder with {ENTRY}, with `{wanted}`")
    if file.suffix != ".py":
        raise AgentError(f"{path}: not a Python file; a submission is a .py file, or a folder with {ENTRY}")
    imports = _Imports(file.parent)
    module = _execute(file, imports)
    make = getattr(module, function, None)
    if not callable(make):
        raise AgentError(f"{file}: defines no {function}; write `{wanted}`")
    seeds = getattr(module, "TRAINING_SEEDS", 1)
    if isinstance(seeds, bool) or not isinstance(seeds, int) or seeds < 1:
        raise AgentError(
            f"{file}: TRAINING_SEEDS is {seeds!r}; write a whole number from 1, such as TRAINING_SEEDS = 3"
        )

    def make_agent(layout: str, training_seed: int) -> Agent:
        if not 0 <= training_seed < seeds:
            raise AgentError(
                f"{file}: no training seed {training_seed}; TRAINING_SEEDS = {seeds} means 0 to {seeds - 1}"
            )
        try:
            with imports.open():
                agent = make(layout, training_seed)
        except UnknownLayout:
            raise
        except (Exception, SystemExit) as error:
            raise _told(error, file, f"{function}({layout!r}, {training_seed})") from error
        check_agent(agent, f"{file}, {function}({layout!r}, {training_seed})")
        return agent  # type: ignore[no-any-return]

    name = path.name if path.is_dir() else path.stem
    return Submission(name, path, seeds, make_agent, hash_submission(path))


def hash_submission(path: str | Path) -> str:
    """Computes a submission's SHA-256, hexadecimal.

    Args:
        path: A file, whose content is hashed; or a folder, where every file counts with its name. Left out are caches,
            hidden files and folders, and the folder `scores` directly in it, where `score .` writes.
    """
    path = Path(path)
    if path.is_file():
        return hashlib.sha256(path.read_bytes()).hexdigest()
    whole = hashlib.sha256()
    found = {file.relative_to(path).as_posix(): file for file in path.rglob("*") if file.is_file()}
    for name, file in sorted(found.items()):
        parts = name.split("/")
        if parts[0] != "scores" and not any(part == "__pycache__" or part.startswith(".") for part in parts):
            whole.update(f"{name}\0{hashlib.sha256(file.read_bytes()).hexdigest()}\n".encode())
    return whole.hexdigest()


def _execute(file: Path, imports: "_Imports") -> ModuleType:
    name = f"{_PREFIX}{next(_numbers)}"
    spec = spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[name] = module  # dataclasses and pickling look their module up there
    try:
        with imports.open():
            spec.loader.exec_module(module)
    except (Exception, SystemExit) as error:
        del sys.modules[name]
        raise _told(error, file, "while it was imported") from error
    return module


def _told(error: BaseException, file: Path, when: str) -> AgentError:
    """Makes one line of an error: the submission's last line that was running, and the original message."""
    if isinstance(error, SyntaxError) and error.filename:
        return AgentError(f"{error.filename}, line {error.lineno}: {type(error).__name__}: {error.msg}")
    lines = [
        f"{frame.filename}, line {frame.lineno}"
        for frame in traceback.extract_tb(error.__traceback__)
        if Path(frame.filename).parent == file.parent
    ]
    text = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
    return AgentError(f"{lines[-1] if lines else file}: {text} ({when})")


class _Imports:
    """Lets a submission import what lies beside it, without leaving a trace for anybody else.

    Two submissions may both have a `helper.py`: while one's code runs, its own helpers stand in `sys.modules`, and
    foreign modules of their names do not.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._own: dict[str, ModuleType] = {}

    @contextmanager
    def open(self) -> Iterator[None]:
        folder, before = str(self._folder), dict(sys.modules)
        no_bytecode, sys.dont_write_bytecode = sys.dont_write_bytecode, True
        beside = self._names() - set(sys.stdlib_module_names)
        for name in before:
            top = name.partition(".")[0]
            if top in beside and not self._lies_here(before.get(top)):
                del sys.modules[name]
        sys.modules.update(self._own)
        sys.path.insert(0, folder)
        try:
            yield
        finally:
            sys.dont_write_bytecode = no_bytecode
            if folder in sys.path:
                sys.path.remove(folder)
            found = dict(sys.modules)
            tops = {name for name in found if found[name] is not before.get(name) and self._lies_here(found[name])}
            self._own = {name: module for name, module in found.items() if name.partition(".")[0] in tops}
            for name in self._own:
                del sys.modules[name]
            sys.modules.update({name: module for name, module in before.items() if name not in sys.modules})

    def _names(self) -> set[str]:
        files = {file.stem for file in self._folder.glob("*.py")}
        return files | {package.parent.name for package in self._folder.glob("*/__init__.py")}

    def _lies_here(self, module: Any) -> bool:
        """Tells whether a module is a file or a package directly in the folder (and not a submission itself)."""
        if str(getattr(module, "__name__", "")).startswith(_PREFIX):
            return False
        told = getattr(module, "__dict__", {})  # some libraries' modules invent any attribute they are asked for
        homes = [str(path) for path in told.get("__path__") or ()] or [str(told.get("__file__") or "")]
        return any(Path(home).parent == self._folder for home in homes)
