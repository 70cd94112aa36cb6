"""The contract of agents, and what helps to keep it: random draws that belong to a row, an adapter for single games.

Axes: B = simultaneous episodes (rows).
"""

import operator
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Any, Final, Protocol, runtime_checkable

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.kitchen.codes import NUM_ACTIONS

_GOLDEN, _MIX_1, _MIX_2 = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB
_WORD: Final = 2**64 - 1
_ROUNDING: Final = 1e-3  # what a softmax in float16 may miss


class UnknownLayout(ValueError):
    """An agent cannot play the layout that it was asked to play; scoring lists that layout as not attempted."""


class GameError(RuntimeError):
    """One of the players of `one_game_at_a_time` failed or answered with no action.

    Attributes:
        row: Which game it played, an index into the rows of `reset`.
    """

    def __init__(self, message: str, row: int) -> None:
        super().__init__(message)
        self.row = row


@runtime_checkable
class Agent(Protocol):
    """Whoever sits on a seat: one object serves B simultaneous episodes, which all start together.

    Row i's randomness depends on `seeds[i]` and the number of steps since `reset` alone, so that a row plays the same
    in every batch; `sample_actions` sees to that.

    Attributes:
        observation: What `act` is given: "lossless", "lossless26", "features", "stack_channels", "stack_states", or
            "state" for a list of B `KitchenState`.
    """

    observation: str

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts B new episodes.

        Args:
            layout: The layout's name, for a custom grid its text.
            seats: (B,) int, 0 or 1, the chef that this agent is in each row.
            seeds: (B,) uint64, one for each row.

        Raises:
            UnknownLayout: This agent cannot play that layout.
        """
        ...

    def act(self, observations: Any) -> ArrayLike:
        """Chooses one action a row.

        Args:
            observations: (B, ...) as this agent's own seats see it; for "state" a list of B `KitchenState`.

        Returns:
            (B,) whole numbers: 0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact.
        """
        ...


def uniforms(seeds: NDArray[np.uint64], step: int) -> NDArray[np.float64]:
    """Draws one number in [0, 1) a row; it depends on the row's seed and the step alone.

    Args:
        seeds: (B,) uint64.
        step: Steps since the start, from 0; another step gives an independent draw.

    Returns:
        (B,) float64.

    Source: Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators" (SplitMix64's finaliser).
    """
    keys = _mixed(np.asarray(seeds, np.uint64) + np.uint64(_GOLDEN))
    bits = _mixed(keys + np.uint64((step + 1) * _GOLDEN & _WORD))
    return (bits >> np.uint64(11)).astype(np.float64) * 2.0**-53


def sample_actions(probabilities: ArrayLike, seeds: NDArray[np.uint64], step: int) -> NDArray[np.int64]:
    """Draws one action a row; row i's draw depends on its probabilities, its seed and the step alone.

    Args:
        probabilities: (B, 6), each row of sum 1 up to rounding. An action of probability 0 is never drawn.
        seeds: (B,) uint64.
        step: Steps since the start, from 0.

    Returns:
        (B,) int64.

    Raises:
        ValueError: A wrong shape, a negative or undefined probability, or a row that does not sum to 1.
    """
    chances = np.asarray(probabilities, np.float64)
    if chances.shape != (len(seeds), NUM_ACTIONS):
        raise ValueError(
            f"probabilities have the shape {chances.shape}; {len(seeds)} seeds need ({len(seeds)}, {NUM_ACTIONS})"
        )
    sums = np.cumsum(chances, axis=1)
    good = (chances >= 0).all(axis=1) & (np.abs(sums[:, -1] - 1) <= _ROUNDING)
    if not good.all():
        row = int(np.argmin(good))
        raise ValueError(f"row {row}: {chances[row].tolist()}; give six probabilities, from 0, that sum to 1")
    drawn = np.sum(sums <= uniforms(seeds, step)[:, None], axis=1, dtype=np.int64)
    last = NUM_ACTIONS - 1 - np.argmax(chances[:, ::-1] > 0, axis=1)  # rounding may end a row's sum below its draw
    actions: NDArray[np.int64] = np.minimum(drawn, last)
    return actions


def _mixed(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    z = (z ^ (z >> np.uint64(30))) * np.uint64(_MIX_1)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(_MIX_2)
    return z ^ (z >> np.uint64(31))


def one_game_at_a_time(factory: Callable[[], Any], observation: str | None = None) -> Agent:
    """Makes an Agent of plain objects that play one game each.

    Args:
        factory: Called without arguments once for every row at every reset; usually a class. Its objects have
            `act(observation) -> int`, and may have `reset(layout: str, seat: int, seed: int)`, called once before
            the game. Where one of them raises or returns no whole number, the Agent raises a GameError with its row.
        observation: What `act` is given; taken from the factory's or its objects' attribute `observation` where absent.

    Returns:
        An Agent that hands row i to the i-th object.

    Raises:
        TypeError: The factory cannot be called so, or its objects have no `act`.
        ValueError: It is said nowhere which observation is wanted.

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
        raise TypeError(f"one_game_at_a_time got {factory!r}; give a class or function that makes one player a game")
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
            except (TypeError, OverflowError):
                raise GameError(
                    f"row {row}: {_name(self._factory)}'s act returned {action!r}; return one whole number from 0 to 5",
                    row,
                ) from None
        return actions

    @contextmanager
    def _blaming(self, row: int, method: str) -> Iterator[None]:
        try:
            yield
        except UnknownLayout:
            raise
        except (Exception, SystemExit) as error:
            told = f"{type(error).__name__}: {error}" if str(error) else type(error).__name__
            raise GameError(f"row {row}: {_name(self._factory)}'s {method} raised {told}", row) from error


def _make(factory: Callable[[], Any]) -> Any:
    player = factory()
    if not callable(getattr(player, "act", None)):
        raise TypeError(f"{_name(factory)}() gave {player!r}; it needs a method act(observation) -> int")
    return player


def _name(factory: Callable[[], Any]) -> str:
    return str(getattr(factory, "__name__", factory))
