"""The random streams of a score: what each depends on, and what cannot be inferred from them.

The scored agent's seeds and the order of its rows depend on nothing about its partners, so it cannot look a partner up
by its seed. Under a protocol's public salt, code that repeats this file can still compute the order of the rows and the
start states, and so find out who sits where. Under a fresh salt it cannot, unless it reaches for the salt inside the
process that plays it, where nothing is hidden.

Axes: N rows of a block.
"""

import hashlib
import re
import secrets
from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

FRESH: Final = "fresh"
"""The word for a salt that is drawn when a score starts and was never public."""


def stream_key(*parts: str | int) -> int:
    """Returns a 64-bit key that depends on the parts alone, never on what else is played or on the version of numpy.

    Args:
        parts: Texts and whole numbers; ("a", 1) and ("a1",) and ("a", "1") differ.
    """
    digest = hashlib.sha256(repr(tuple(parts)).encode()).digest()
    return int.from_bytes(digest[:8], "little")


def draw_salt() -> str:
    """Draws a new secret salt."""
    return secrets.token_hex(16)


def is_drawn(salt: str) -> bool:
    """Returns whether a salt has the form of those that `draw_salt` draws, so that one can be given again."""
    return re.fullmatch("[0-9a-f]{32}", salt) is not None


class Streams(NamedTuple):
    """The streams of one episode index on one layout.

    Attributes:
        play_sha256: Hash of what is played, `Protocol.sha256`.
        salt: The run's.
        seed: Of the whole score.
        layout: Its name.
        episode: Index of the start states.
    """

    play_sha256: str
    salt: str
    seed: int
    layout: str
    episode: int

    def order(self, rows: int) -> list[int]:
        """Returns the order in which the rows are dealt: a permutation of range(rows)."""
        return sorted(range(rows), key=lambda row: stream_key(*self, "row", row))

    def start(self, partner: str) -> int:
        """Returns the key of the start state that a partner, given by its hash, is met in from every seat."""
        return stream_key(*self, "start", partner)

    def seeds(self, partners: Sequence[str], seats: NDArray[np.int64]) -> NDArray[np.uint64]:
        """Returns the seeds of both chefs.

        Args:
            partners: N hashes, one per row.
            seats: (N,) the scored agent's seat.

        Returns:
            (N, 2) by seat: the scored agent's seed depends on the row, its partner's on the partner and the seat.
        """
        seeds = np.empty((len(seats), 2), np.uint64)
        for row, (partner, seat) in enumerate(zip(partners, seats.tolist(), strict=True)):
            seeds[row, seat] = stream_key(*self, "ego", row)
            seeds[row, 1 - seat] = stream_key(*self, "partner", partner, seat)
        return seeds

    def of_process(self, training_seed: int) -> int:
        """Returns the seed of the global generators, for submissions that draw from them."""
        return stream_key(*self, "process", training_seed)
