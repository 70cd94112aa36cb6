"""Finds submissions without running them here, and makes agents of them that play in processes of their own."""

import weakref
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent, GameError, Reference, UnknownLayout
from overcooked_bench.agents.isolation import frames
from overcooked_bench.agents.isolation.frames import Message
from overcooked_bench.agents.isolation.player import Facts, Made, Wanted
from overcooked_bench.agents.isolation.remote import Remote
from overcooked_bench.agents.isolation.sandbox import Sandbox
from overcooked_bench.agents.isolation.settings import Isolation
from overcooked_bench.agents.kinds import Entrant, identity_of
from overcooked_bench.agents.pools.lineage import Origin
from overcooked_bench.agents.seeding import KEY
from overcooked_bench.agents.submissions.checks import (
    ActionError,
    AgentError,
    ForeignFault,
    check_actions,
    checked_observation,
)
from overcooked_bench.agents.submissions.content import content, imported_by
from overcooked_bench.agents.submissions.guard import stamp
from overcooked_bench.agents.submissions.loading import MOST_TRAINING_SEEDS
from overcooked_bench.agents.watch import LOADING
from overcooked_bench.files import shown
from overcooked_bench.kitchen.state import KitchenState

_MOST_FACTS: Final = 1 << 16  # bytes
_LIBRARIES: Final = ("torch", "safetensors", "scipy", "gymnasium", "stable_baselines3", "sb3_contrib")
"""What the template imports if the submission does; importing takes seconds, and runs no code of the submission."""
_PLAYING: Final = (b"load_agent", b"Kitchens", b"planner")
"""What is in sources that need the modules below."""
_KITCHEN: Final = ("overcooked_bench.agents.planner.planner", "overcooked_bench.kitchen.kitchens")


def find_isolated(reference: Reference, kind: str, isolation: Isolation) -> Entrant:
    """Finds a submission; its code runs in processes of its own only, one for each agent.

    Args:
        reference: As `catalogue.find` takes it.
        kind: "submission" or "function".
        isolation: How it is isolated.

    Raises:
        AgentError: Its code is at fault.
        IsolationError: Its processes cannot be started.
    """
    identity = identity_of(reference, kind)
    factory = _Factory(identity.path, identity.function, isolation)
    facts = factory.facts()
    origin = None if facts.people is None else Origin(facts.codebase, facts.people)
    return Entrant(
        *(identity.reference, identity.name, kind, identity.sha256, factory),
        training_seeds=facts.training_seeds,
        origin=origin,
    )


class _Factory:
    """Makes the agents of a submission.

    Args:
        path: The submission.
        function: The function in it that makes agents.
        isolation: How it is isolated.
    """

    def __init__(self, path: Path, function: str, isolation: Isolation) -> None:
        self._path, self._function, self._isolation = path, function, isolation
        self._files = list(content(path).values())
        self._stamps = {file: stamp(file) for file in self._files}
        self._sandbox: Sandbox | None = None

    def __call__(self, layout: str, training_seed: int) -> Agent:
        """Makes an agent, in a process in which no other one has played."""
        for file, before in self._stamps.items():
            if stamp(file) != before:
                raise AgentError(f"{file} was changed after it was hashed; run it again, with another --output")
        wanted = msgspec.json.encode(Wanted(layout, training_seed, KEY.get()))
        call = f"{self._function}({shown(layout)!r}, {training_seed})"
        remote, data = self._ask(Message(frames.MAKE, 0), wanted, call)
        try:
            made = msgspec.json.decode(data, type=Made)
            checked_observation(made)
        except (msgspec.MsgspecError, UnicodeError, RecursionError, AgentError):
            remote.close()
            raise AgentError(f"{self._path}: {call}: its process sent what is no answer") from None
        return IsolatedAgent(remote, made.observation)

    def facts(self) -> Facts:
        """Returns what the submission says about itself."""
        remote, data = self._ask(Message(frames.FACTS, 0), b"", "while it was imported")
        remote.close()
        try:
            facts = msgspec.json.decode(data, type=Facts)
        except (msgspec.MsgspecError, UnicodeError, RecursionError):
            raise AgentError(f"{self._path}: its process sent what is no answer") from None
        if not 1 <= facts.training_seeds <= MOST_TRAINING_SEEDS:
            raise AgentError(f"{self._path}: TRAINING_SEEDS is {facts.training_seeds}")
        return facts

    def _ask(self, request: Message, data: bytes, what: str) -> tuple[Remote, bytes]:
        """Starts a process and has it load the submission."""
        try:
            if self._sandbox is None or not self._sandbox.is_open:
                self._sandbox = Sandbox(
                    self._path, self._function, self._files, list(_libraries(self._path)), _kernels(), self._isolation
                )
            remote = Remote(self._sandbox)
            answer, found = remote.ask(request, data, _MOST_FACTS, "loading", LOADING)
        except ForeignFault as fault:
            raise AgentError(f"{self._path}: {fault} ({what})") from None
        if answer.kind == frames.DONE:
            return remote, found
        remote.close()
        text = _text(found)
        if answer.kind == frames.DECLINED:
            raise UnknownLayout(text)
        raise AgentError(text if answer.kind == frames.AT_FAULT else f"{self._path}: {text} ({what})")


class IsolatedAgent:
    """An agent that plays in a process of its own, which ends with this object.

    Args:
        remote: The process, in which the agent was made.
        observation: Its observation.
    """

    def __init__(self, remote: Remote, observation: str) -> None:
        self.observation = observation
        self._remote = remote
        weakref.finalize(self, remote.close)

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts new episodes."""
        named = layout.encode()
        data = seats.astype(np.int64).tobytes() + seeds.astype(np.uint64).tobytes() + named
        request = Message(frames.RESET, 0, shape=(len(seats), len(named)))
        self._ask(request, data, 0, "reset", LOADING)

    def act(self, observations: Any) -> NDArray[np.int64]:
        """Chooses one action per row."""
        rows = len(observations)
        data: bytes | NDArray[Any]
        if isinstance(observations, np.ndarray):
            request = Message(frames.ACT, 0, dtype=observations.dtype.str, shape=observations.shape)
            data = observations
        else:
            states: list[KitchenState] = observations
            request, data = Message(frames.STATES, 0), msgspec.json.encode([state.to_dict() for state in states])
        found = self._ask(request, data, rows, "act")
        return check_actions(np.frombuffer(found, np.uint8), rows)

    def _ask(
        self, request: Message, data: "bytes | NDArray[Any]", most: int, what: str, allowance: float = 1.0
    ) -> bytes:
        answer, found = self._remote.ask(request, data, most, what, allowance)
        if answer.kind == frames.DONE:
            return found
        text = _text(found)
        if answer.kind == frames.DECLINED:
            raise UnknownLayout(text)
        if answer.kind == frames.NO_ACTION:
            raise ActionError(text, answer.row if answer.row >= 0 else None)
        if answer.kind == frames.GAME:
            raise GameError(text, answer.row)
        raise ForeignFault(text, raised=True)


def _text(data: bytes) -> str:
    """Returns a text of a submission, as one printable line."""
    return shown(data.decode("utf-8", "replace"), frames.LONGEST_TEXT)


def _libraries(path: Path) -> Iterator[str]:
    """Yields the modules that the template imports."""
    yield "overcooked_bench.kitchen.observations.registry"  # which the names of observations are checked with
    mentioned = imported_by(path)
    yield from (name for name in _LIBRARIES if name in mentioned)
    if "overcooked_bench" in mentioned and any(name in source for source in _sources(path) for name in _PLAYING):
        yield from _KITCHEN


def _sources(path: Path) -> Iterator[bytes]:
    """Yields the sources of a submission."""
    for file in content(path).values():
        if file.suffix == ".py":
            yield file.read_bytes()


def _kernels() -> list[Path]:
    """Lists the folders of the kitchen's compiled kernels, which take many seconds to compile."""
    from overcooked_bench.kitchen.jit import FOLDERS

    return sorted(FOLDERS)
