"""Runs a submission's code with its own imports, watched files, and settings that do not leak."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from numpy.typing import ArrayLike, NDArray

from overcooked_bench.agents.agent import Agent
from overcooked_bench.agents.submissions.guard import Guard
from overcooked_bench.agents.submissions.imports import Imports
from overcooked_bench.agents.submissions.surroundings import Surroundings


class Running:
    """Runs a submission's code.

    Args:
        imports: The modules of its folder that it can import.
        guard: The files of its folder that it may open.
    """

    def __init__(self, imports: Imports, guard: Guard) -> None:
        self._imports, self._guard, self._surroundings = imports, guard, Surroundings()

    @contextmanager
    def playing(self) -> Iterator[None]:
        """Runs code that plays.

        Raises:
            AgentError: It opened a file that it may not.
        """
        with self._surroundings.inside(), self._guard.watch():
            yield

    @contextmanager
    def importing(self) -> Iterator[None]:
        """Runs code that may import modules of its folder.

        Raises:
            AgentError: It opened a file that it may not.
        """
        with self._imports.open(), self.playing():
            yield


class SubmittedAgent:
    """An agent of a submission: its code runs as `Running` says.

    Args:
        agent: The agent.
        observation: Its observation.
        running: Its submission's `Running`.
    """

    def __init__(self, agent: Agent, observation: str, running: Running) -> None:
        self.observation = observation
        self._agent, self._running = agent, running

    def reset(self, layout: str, seats: NDArray[Any], seeds: NDArray[Any]) -> None:
        """Starts new episodes."""
        with self._running.playing():
            self._agent.reset(layout, seats, seeds)

    def act(self, observations: Any) -> ArrayLike:
        """Chooses one action per row."""
        with self._running.playing():
            return self._agent.act(observations)

    def __getattr__(self, name: str) -> Any:
        if name.startswith("_"):
            raise AttributeError(name)
        return getattr(self._agent, name)
