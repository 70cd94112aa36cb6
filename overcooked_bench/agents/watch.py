"""Which call of a submission's code is under way, noted where the parent process can read it.

A worker process notes every such call here. Its parent sees one that takes too long, ends the worker, and knows what
was called. Where no parent watches, a note costs next to nothing.
"""

from collections.abc import Iterator
from contextlib import AbstractContextManager, contextmanager, nullcontext
from multiprocessing.context import SpawnContext
from typing import Final

LOADING: Final = 10.0
"""Allowance of calls that load an agent or start its episodes, as `calling` takes it."""

NO_ANSWER: Final = "no answer within"
"""Is in the message of every overdue call."""

_LONGEST: Final = 120


class Board:
    """Memory that a worker and its parent share.

    Args:
        context: What the worker is started with.
    """

    def __init__(self, context: SpawnContext) -> None:
        self._calls = context.RawValue("Q", 0)  # odd while a call is under way
        self._allowance = context.RawValue("d", 1.0)
        self._what = context.RawArray("c", _LONGEST)

    @property
    def call(self) -> int:
        """The number of the call that is under way, 0 between calls."""
        return int(self._calls.value) if self._calls.value % 2 else 0

    @property
    def allowance(self) -> float:
        """How many times the usual limit the call may take."""
        return float(self._allowance.value)

    @property
    def what(self) -> str:
        """What is called, in words, such as "act, step 12"."""
        return bytes(self._what.value).decode("utf-8", "replace")

    @contextmanager
    def note(self, what: str, allowance: float) -> Iterator[None]:
        """Notes a call; one inside another is part of it."""
        if self.call:
            yield
            return
        self._what.value = what.encode()[: _LONGEST - 1]
        self._allowance.value = allowance
        self._calls.value += 1
        try:
            yield
        finally:
            self._calls.value += 1


_board: Board | None = None
_UNWATCHED: Final = nullcontext()


def watch_by(board: Board) -> None:
    """Notes all calls of this process on a board from now on."""
    global _board
    _board = board


def calling(what: str, allowance: float = 1.0) -> AbstractContextManager[None]:
    """Notes that a submission's code is called.

    Args:
        what: In words, for a message.
        allowance: How many times the usual limit this call may take; loading takes longer than acting.
    """
    return _UNWATCHED if _board is None else _board.note(what, allowance)
