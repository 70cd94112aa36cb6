"""The contract of agents, and an adapter for agents that play one game at a time; for random draws see `draws`.

Axes: B = simultaneous episodes (rows).
"""

import operator
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.agents.draws import sample_actions, uniforms
from overcooked_bench.agents.saying import describe, value
from overcooked_bench.errors import AgentFault, WrongUse

__all__ = ["Agent", "GameError", "UnknownLayout", "one_game_at_a_time", "sample_actions", "uniforms"]


class UnknownLayout(WrongUse):
    """An agent cannot play the layout that it was asked to play; scoring lists that layout as not attempted."""


class GameError(AgentFault):
    """One of the players of `one_game_at_a_time` raised an error or returned something that is not an action.

    Attributes:
        row: The game that it played, an index into the rows of `reset`.
    """

    def __init__(self, message: str, row: int) -> None:
        super().__init__(message)
        self.row = row


@runtime_checkable
class Agent(Protocol):
    """A policy that plays one seat: one object serves B simultaneous episodes, which all start together.

    Row i's actions depend only on its observations, `seeds[i]` and the number of steps since `reset`, so that a row
    plays the same in every batch; `sample_actions` draws actions in that way.

    Attributes:
        observation: The observation that `act` takes: "lossless", "lossless26", "lossless_2019", "blind", "features",
            "stack_channels", "stack_states", or "state" for a list of B `KitchenState`.
    """

    observation: str

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts B new episodes.

        Args:
            layout: The layout's name, for a custom grid its text.
            seats: (B,) int, 0 or 1, this agent's seat in each row.
            seeds: (B,) uint64, one for each row.

        Raises:
            UnknownLayout: This agent cannot play that layout.
        """
        ...

    def act(self, observations: Any) -> ArrayLike:
        """Chooses one action per row.

        Args:
            observations: (B, ...) from this agent's seats; for "state" a list of B `KitchenState`.

        Returns:
            (B,) whole numbers: 0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact.
        """
        ...


Reference = str | Path | Mapping[str, Any]
"""A reference to an agent, see `catalogue.find`: a name, a path, or a behaviour mapping such as `{"does": "carry"}`."""

AgentFactory = Callable[[str, int], Agent]
"""`make_agent(layout, training_seed)`, as submissions define it."""


def one_game_at_a_time(factory: Callable[[], Any], observation: str | None = None) -> Agent:
    """Makes an Agent from plain objects that play one game each.

    Args:
        factory: Called without arguments once for every row at every reset; usually a class. Its objects have
            `act(observation) -> int`, and may have `reset(layout: str, seat: int, seed: int)`, called once before
            the game. If one of them raises or does not return a whole number, the Agent raises a GameError with its
            row.
        observation: The observation that `act` takes; by default the factory's or its objects' attribute `observation`.

    Returns:
        An Agent that passes row i to the i-th object.

    Raises:
        TypeError: The factory cannot be called without arguments, or its objects have no `act`.
        ValueError: Neither the argument nor an attribute names the observation.

    Example:
        ```python
        class Waits:
            observation = "features"

            def act(self, observation):
                return 4

        def make_agent(layout, training_seed):
            return one_game_at_a_time(Waits)
        ```
    """
    if not callable(factory):
        raise TypeError(f"one_game_at_a_time got {factory!r}; give a class or function that makes one player per game")
    named = observation or getattr(factory, "observation", None)
    if not isinstance(named, str):
        named = getattr(_make(factory), "observation", None)
    if not isinstance(named, str):
        raise ValueError(
            f"one_game_at_a_time({_name(factory)}) does not know what to observe; set observation = 'lossless26' in "
            "the class, or write one_game_at_a_time(factory, observation='lossless26')"
        )
    return _OneGameAtATime(factory, named)


class _OneGameAtATime:
    """The adapter of `one_game_at_a_time`."""

    def __init__(self, factory: Callable[[], Any], observation: str) -> None:
        self.observation = observation
        self._factory = factory
        self._players: list[Any] = []

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        self._players = [_make(self._factory) for _ in seats]
        for row, (player, seat, seed) in enumerate(zip(self._players, seats, seeds, strict=True)):
            if hasattr(player, "reset"):
                with self._blaming(row, "reset"):
                    player.reset(layout, int(seat), int(seed))

    def act(self, observations: Any) -> NDArray[np.int64]:
        if len(observations) != len(self._players):
            raise ValueError(f"{len(observations)} observations for the {len(self._players)} games of reset()")
        actions = np.empty(len(self._players), np.int64)
        for row, (player, seen) in enumerate(zip(self._players, observations, strict=True)):
            with self._blaming(row, "act"):
                action = player.act(seen)
            try:
                actions[row] = operator.index(action)
            except KeyboardInterrupt:
                raise
            except BaseException:
                told = f"{_name(self._factory)}'s act returned {value(action)}; return one whole number from 0 to 5"
                raise GameError(f"row {row}: {told}", row) from None
        return actions

    @contextmanager
    def _blaming(self, row: int, method: str) -> Iterator[None]:
        try:
            yield
        except (UnknownLayout, KeyboardInterrupt):
            raise
        except BaseException as error:
            raise GameError(f"row {row}: {_name(self._factory)}'s {method} raised {describe(error)}", row) from error


def _make(factory: Callable[[], Any]) -> Any:
    player = factory()
    if not callable(getattr(player, "act", None)):
        raise TypeError(f"{_name(factory)}() gave {value(player)}; it needs a method act(observation) -> int")
    return player


def _name(factory: Callable[[], Any]) -> str:
    return str(getattr(factory, "__name__", factory))
