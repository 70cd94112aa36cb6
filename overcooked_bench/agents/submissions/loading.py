"""A submission: a Python file, or a folder with `agent.py`, that defines `make_agent(layout, training_seed)`.

Its code runs in this process, as every Python module's does; we unpickle none of its files.
"""

import sys
import traceback
from collections.abc import Callable
from dataclasses import dataclass
from importlib.util import module_from_spec, spec_from_file_location
from itertools import count
from pathlib import Path
from types import ModuleType
from typing import Final

from overcooked_bench.agents.agent import Agent, UnknownLayout
from overcooked_bench.agents.pools.lineage import Origin
from overcooked_bench.agents.saying import describe, say, value
from overcooked_bench.agents.submissions.checks import AgentError, check_agent
from overcooked_bench.agents.submissions.content import ENTRY, content, hash_submission
from overcooked_bench.agents.submissions.guard import Guard
from overcooked_bench.agents.submissions.imports import PREFIX, Imports
from overcooked_bench.agents.submissions.running import Running, SubmittedAgent

MAKE_AGENT: Final = "make_agent"
MOST_TRAINING_SEEDS: Final = 1000
THIS_CODEBASE: Final = "overcooked-bench"
_WANTED: Final = "def {}(layout: str, training_seed: int) -> Agent"
_numbers = count()


@dataclass(frozen=True)
class Submission:
    """A submission that was loaded.

    Attributes:
        name: Its file's stem, or its folder's name.
        path: The file or folder.
        training_seeds: Number of independent training runs: `make_agent` takes 0 to training_seeds - 1.
        make_agent: `make_agent(layout, training_seed)` returns an agent that keeps the contract as far as can be seen;
            raises UnknownLayout if the submission does, and AgentError for every other fault.
        sha256: Hash of its files, see `content.hash_submission`; hexadecimal.
        origin: What `CODEBASE` and `PEOPLE` say; None if it defines neither.
    """

    name: str
    path: Path
    training_seeds: int
    make_agent: Callable[[str, int], Agent]
    sha256: str
    origin: Origin | None


def load_submission(path: str | Path, function: str = MAKE_AGENT) -> Submission:
    """Loads a submission as a separate module; only it can import the modules in its folder.

    While its code runs, it cannot open files of its folder that are not in its hash: a score that is resumed plays the
    same agent, or reports that it was changed. Files elsewhere are not watched.

    Args:
        path: A Python file, or a folder with `agent.py`.
        function: The function in it that makes the agents.

    Raises:
        AgentError: No such file, its code fails, or it does not define what it should; names file and line.
    """
    path, file = Path(path).absolute(), entry_file(path, function)
    found = content(path)
    running = Running(Imports(file.parent), Guard(file.parent, found, path.is_dir()))
    sha256 = hash_submission(path)
    module = _execute(file, running)
    make = getattr(module, function, None)
    if not callable(make):
        raise AgentError(f"{file}: defines no {function}; write `{_WANTED.format(function)}`")
    seeds = getattr(module, "TRAINING_SEEDS", 1)
    if type(seeds) is not int or not 1 <= seeds <= MOST_TRAINING_SEEDS:
        raise AgentError(
            f"{file}: TRAINING_SEEDS is {value(seeds)}; write a whole number from 1 to {MOST_TRAINING_SEEDS}, such as "
            "TRAINING_SEEDS = 3"
        )

    def make_agent(layout: str, training_seed: int) -> Agent:
        if not 0 <= training_seed < seeds:
            raise AgentError(
                f"{file}: no training seed {training_seed}; TRAINING_SEEDS = {seeds} means 0 to {seeds - 1}"
            )
        call = f"{function}({layout!r}, {training_seed})"
        try:
            with running.importing():
                agent = make(layout, training_seed)
                observation = check_agent(agent, f"{file}, {call}")
        except KeyboardInterrupt:
            raise
        except UnknownLayout as error:
            raise UnknownLayout(say(error)) from None
        except BaseException as error:
            raise _explained(error, file, call) from error
        return SubmittedAgent(agent, observation, running)

    name = path.name if path.is_dir() else path.stem
    return Submission(name, path, seeds, make_agent, sha256, _origin(module, file))


def entry_file(path: str | Path, function: str = MAKE_AGENT) -> Path:
    """Returns the file of a submission that is executed.

    Args:
        path: A Python file, or a folder with `agent.py`.
        function: The function that it should define, for messages.

    Raises:
        AgentError: There is no such file.
    """
    path, wanted = Path(path).absolute(), _WANTED.format(function)
    file = path / ENTRY if path.is_dir() else path
    if not file.is_file():
        what = f"no {ENTRY} in this folder" if path.is_dir() else "no such file"
        raise AgentError(f"{path}: {what}; a submission is a Python file, or a folder with {ENTRY}, with `{wanted}`")
    if file.suffix != ".py":
        raise AgentError(f"{path}: not a Python file; a submission is a .py file, or a folder with {ENTRY}")
    return file


def _origin(module: ModuleType, file: Path) -> Origin | None:
    """Reads where the agents come from, as far as the submission says."""
    if not (hasattr(module, "CODEBASE") or hasattr(module, "PEOPLE")):
        return None
    codebase, people = getattr(module, "CODEBASE", ""), getattr(module, "PEOPLE", ())
    if type(codebase) is not str:
        raise AgentError(
            f"{file}: CODEBASE is {value(codebase)}; write the project whose training code made the agents, such as "
            f'CODEBASE = "stable-baselines3", or "{THIS_CODEBASE}", or "" if nobody trained them'
        )
    if type(people) not in (list, tuple) or not all(type(person) is str for person in people):
        raise AgentError(
            f"{file}: PEOPLE is {value(people)}; list those whose recorded games the agents or their training partners "
            'were made from, such as PEOPLE = ["2019-00", "2019-02"]'
        )
    return Origin(None if codebase == THIS_CODEBASE else codebase, tuple(people))


def _execute(file: Path, running: Running) -> ModuleType:
    name = f"{PREFIX}{next(_numbers)}"
    spec = spec_from_file_location(name, file)
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    sys.modules[name] = module  # dataclasses and pickling look their module up there
    try:
        with running.importing():
            spec.loader.exec_module(module)
    except BaseException as error:
        sys.modules.pop(name, None)
        if isinstance(error, KeyboardInterrupt):
            raise
        raise _explained(error, file, "while it was imported") from error
    return module


def _explained(error: BaseException, file: Path, when: str) -> AgentError:
    """Describes an error in one line: the submission's last line that was running, and the original message."""
    if type(error) is AgentError:  # one of ours, whose message is complete
        return error
    if type(error) is SyntaxError and error.filename:
        return AgentError(f"{error.filename}, line {error.lineno}: {describe(error)}")
    lines = [
        f"{frame.filename}, line {frame.lineno}"
        for frame in traceback.extract_tb(error.__traceback__)
        if Path(frame.filename).parent == file.parent
    ]
    return AgentError(f"{lines[-1] if lines else file}: {describe(error)} ({when})")
