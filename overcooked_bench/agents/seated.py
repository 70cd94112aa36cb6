"""`Seated`: an agent on its seats. The only place that asks an agent for actions, and that blames it.

An agent's code is not trusted: whatever it raises or returns ends in actions or in a `SeatedFault`.

Axes: N kitchens, B rows of one agent.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent, GameError, UnknownLayout
from overcooked_bench.agents.saying import describe, say
from overcooked_bench.agents.submissions.checks import (
    ActionError,
    AgentError,
    ForeignFault,
    check_actions,
    checked_observation,
)
from overcooked_bench.agents.watch import LOADING, calling
from overcooked_bench.errors import AgentFault
from overcooked_bench.kitchen.kitchens import Kitchens

_FEW: Final = 4
"""An agent that sits in no more than one of so many kitchens is shown its own observations only."""
STATE: Final = "state"
"""The observation that is a list of `KitchenState`; all others are arrays that `Kitchens.observe` makes."""


class SeatedFault(AgentFault, ValueError):
    """An agent broke the contract; a ValueError too, which environments raise for what they refuse.

    Attributes:
        who: The agent's name.
        what: What it did, without who and where.
        step: Steps played before; None at the reset.
        row: Index into the agent's rows where one row is to blame, else None.
    """

    def __init__(self, who: str, what: str, step: int | None = None, row: int | None = None) -> None:
        self.who, self.what, self.step, self.row = who, what, step, row
        super().__init__(f"{who}, {self.when}: {what}")

    @property
    def when(self) -> str:
        """Says at which step it was."""
        return "at the reset" if self.step is None else f"step {self.step}"

    def __reduce__(self) -> tuple[type["SeatedFault"], tuple[object, ...]]:
        """Lets it travel from a worker process whole."""
        return SeatedFault, (self.who, self.what, self.step, self.row)


class Views:
    """The observations of the agents of a batch of kitchens at one step; each is made once.

    Args:
        kitchens: The kitchens.
        seats: (N,) the one seat of each kitchen that is observed; both by default.
    """

    def __init__(self, kitchens: Kitchens, seats: NDArray[np.int64] | None = None) -> None:
        self._kitchens, self._seats = kitchens, seats
        self._made: dict[str, NDArray[Any]] = {}
        self._stale: set[str] = set()

    def renew(self) -> None:
        """Looks again, after a step."""
        self._stale = set(self._made)

    def of(self, agent: "Seated") -> Any:
        """Returns what an agent sees, in memory that nobody else reads: (B, ...), or a list of B `KitchenState`."""
        name = agent.observation
        if name == STATE:
            return [self._kitchens.state(row) for row in agent.rows.tolist()]
        fresh = name in self._made and name not in self._stale
        if not fresh and self._seats is None and _FEW * len(agent.rows) <= self._kitchens.num_kitchens:
            return self._kitchens.observe_some(name, agent.rows, agent.seats)
        if name not in self._made:
            self._made[name] = self._kitchens.observe(name, None, self._seats)
        elif not fresh:
            self._kitchens.observe(name, self._made[name], self._seats)
            self._stale.discard(name)
        whole = self._made[name]
        return whole[agent.where] if self._seats is not None else whole[agent.rows, agent.seats]


class Seated:
    """An agent and the seats that it sits on.

    Args:
        agent: The agent.
        name: What messages call it.
        rows: (B,) int64, its kitchens.
        seats: (B,) int64, its seat in each; `reset` can change them.

    Attributes:
        agent: The agent.
        name: Its name.
        rows: (B,) int64.
        seats: (B,) int64.
        where: The rows as a slice if they are neighbours, else `rows`.
        observation: What it is shown, read from the agent once.

    Raises:
        SeatedFault: The agent's `observation` is not an observation.
    """

    def __init__(
        self, agent: Agent, name: str, rows: NDArray[np.int64], seats: NDArray[np.int64] | None = None
    ) -> None:
        self.agent, self.name, self.rows = agent, name, rows
        self.seats = np.zeros(len(rows), np.int64) if seats is None else seats
        neighbours = len(rows) > 0 and bool((np.diff(rows) == 1).all())
        self.where = slice(int(rows[0]), int(rows[-1]) + 1) if neighbours else rows
        self._step: int | None = None
        try:
            self.observation = checked_observation(agent)
        except AgentError as error:
            raise SeatedFault(name, str(error)) from None

    def fit(self, kitchens: Kitchens) -> None:
        """Checks that these kitchens can show what the agent wants to see.

        Raises:
            SeatedFault: They cannot; says why.
        """
        if self.observation != STATE:
            try:
                kitchens.observation_shape(self.observation)
            except ValueError as error:
                raise SeatedFault(self.name, f"its observation cannot be given here: {error}") from error

    def reset(self, layout: str, seeds: NDArray[np.uint64], seats: NDArray[np.int64] | None = None) -> None:
        """Starts new episodes.

        Args:
            layout: The layout's name, for a custom grid its text.
            seeds: (B,) uint64.
            seats: (B,) int64, the agent's seats from now on; as before by default.

        Raises:
            UnknownLayout: The agent cannot play this layout.
            SeatedFault: It raised something else.
        """
        if seats is not None:
            self.seats = seats
        self._step = None
        try:
            with calling("reset", LOADING):
                self.agent.reset(layout, self.seats.copy(), seeds.copy())
        except KeyboardInterrupt:
            raise
        except UnknownLayout as error:
            raise UnknownLayout(say(error)) from None
        except BaseException as error:
            raise self._blame("reset", error) from error
        self._step = 0

    def act(self, seen: Any) -> NDArray[np.int64]:
        """Asks for the next actions.

        Args:
            seen: (B, ...) array or list of B states, as `Views.of` returns it.

        Returns:
            (B,) int64, from 0 to 5, in memory of its own.

        Raises:
            SeatedFault: The agent raised, or answered with something other than one action per row.
        """
        try:
            with calling(f"act, step {self._step}"):
                actions = check_actions(self.agent.act(seen), len(self.rows))
        except KeyboardInterrupt:
            raise
        except ActionError as error:
            raise SeatedFault(self.name, str(error), self._step, error.row) from None
        except BaseException as error:
            raise self._blame("act", error) from error
        self._step = (self._step or 0) + 1
        return actions

    def _blame(self, method: str, error: BaseException) -> SeatedFault:
        if type(error) is GameError and 0 <= error.row < len(self.rows):  # of the adapter of single games
            return SeatedFault(self.name, say(error), self._step, error.row)
        if type(error) is ForeignFault:
            return SeatedFault(self.name, f"{method}() raised {error}" if error.raised else str(error), self._step)
        return SeatedFault(self.name, f"{method}() raised {describe(error)}", self._step)
