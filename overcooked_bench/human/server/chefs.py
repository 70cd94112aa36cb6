"""Who moves a chef: an agent, which is asked in a thread, or a person, whose keys arrive when they do."""

import asyncio
import secrets
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import Any, Protocol

import numpy as np

from overcooked_bench.agents.kinds import Entrant
from overcooked_bench.agents.seated import STATE, Seated, Views
from overcooked_bench.kitchen.codes import STAY
from overcooked_bench.kitchen.kitchens import Kitchens


class Chef(Protocol):
    """A person or an agent that moves a chef."""

    def look(self, kitchens: Kitchens) -> None:
        """Is shown of a new state, before the step."""

    def action(self) -> int:
        """Returns the action of this step, 0 to 5; called once for every step."""


@dataclass
class Person:
    """A person's keys.

    An action is the last key that went down since the last step; else a direction that is held down; else stay.
    """

    _pressed: int | None = None
    _held: list[int] = field(default_factory=list)

    def press(self, action: int) -> None:
        """Notes a key that went down."""
        self._pressed = action
        if action < STAY:
            self._held = [*(held for held in self._held if held != action), action]

    def release(self, action: int) -> None:
        """Notes a key that went up."""
        self._held = [held for held in self._held if held != action]

    def look(self, kitchens: Kitchens) -> None:
        """The person sees the picture."""

    def action(self) -> int:
        """Returns the action of this step."""
        chosen = self._pressed if self._pressed is not None else (self._held or [STAY])[-1]
        self._pressed = None
        return chosen


class AgentChef:
    """An agent on a seat: asked in a thread, so that it never holds up a kitchen.

    If its answer is not there in time its chef stays. The answer then counts for the next step, and after it the agent
    is shown the state of that time.

    Args:
        entrant: The agent.
        kitchens: One kitchen.
        seat: Its seat.
        threads: Where it is asked.
        training_seed: Which of its training runs plays.

    Attributes:
        entrant: The agent.
        late: Steps in which its answer was not there in time.

    Raises:
        UnknownLayout: It cannot play here.
        AgentError: It cannot be made.
        SeatedFault: It cannot be shown this kitchen, or broke its contract at the reset.
    """

    def __init__(
        self, entrant: Entrant, kitchens: Kitchens, seat: int, threads: Executor, training_seed: int = 0
    ) -> None:
        self.entrant, self.late = entrant, 0
        layout = kitchens.layout.name
        row, seats = np.zeros(1, np.int64), np.array([seat], np.int64)
        self._seated = Seated(entrant.make(layout, training_seed), entrant.name, row, seats)
        self._seated.fit(kitchens)
        self._seated.reset(layout, np.array([secrets.randbits(63)], np.uint64))
        self._threads = threads
        self._asked: asyncio.Future[int] | None = None

    def see(self, kitchens: Kitchens) -> Any:
        """Returns what the agent is shown; the first time it may take seconds, in which kernels are compiled."""
        seen = Views(kitchens).of(self._seated)
        return seen if self._seated.observation == STATE else seen.copy()

    def look(self, kitchens: Kitchens) -> None:
        """Asks the agent, unless it is still at an earlier state."""
        if self._asked is None:
            asked = asyncio.get_running_loop().run_in_executor(self._threads, self._ask, self.see(kitchens))
            self._asked = asked

    def action(self) -> int:
        """Returns the agent's answer if it is there, else stay.

        Raises:
            AgentFault: The agent broke its contract.
        """
        if self._asked is None or not self._asked.done():
            self.late += 1
            return STAY
        answer, self._asked = self._asked, None
        return answer.result()

    def _ask(self, seen: object) -> int:
        return int(self._seated.act(seen)[0])


class Taken(Person):
    """A person in the place of an agent, which goes on seeing the game, and is not heard.

    Args:
        agent: Who has been taken over.
    """

    def __init__(self, agent: Chef) -> None:
        super().__init__()
        self._agent = agent

    def look(self, kitchens: Kitchens) -> None:
        """Shows the state to the agent."""
        self._agent.look(kitchens)

    def action(self) -> int:
        """Returns the person's action."""
        self._agent.action()
        return super().action()
