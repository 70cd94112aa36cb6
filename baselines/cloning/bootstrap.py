"""Which pairs of people a clone learns from, a bootstrap sample of pairs, and which it is held against: the others."""

from collections.abc import Sequence
from typing import Final, NamedTuple

import numpy as np

from overcooked_bench.errors import WrongUse

LEAST_HELD_OUT: Final = 2
"""Pairs that a sample leaves out at least; where it leaves out fewer, it is drawn again."""


class Sample(NamedTuple):
    """A bootstrap sample of pairs.

    Attributes:
        drawn: As many names as there are pairs, with repetitions, sorted.
        held_out: The names that were not drawn, sorted.
    """

    drawn: tuple[str, ...]
    held_out: tuple[str, ...]


def bootstrap(pairs: Sequence[str], seed: int) -> Sample:
    """Draws pairs with replacement, never games or steps: what one pair does on two steps is no independent evidence.

    Args:
        pairs: Their names.
        seed: Of the draw.

    Raises:
        WrongUse: There are too few pairs to leave some out.
    """
    if len(pairs) <= LEAST_HELD_OUT:
        raise WrongUse(
            f"games of {len(pairs)} pairs ({', '.join(pairs) or 'none'}) on this layout; a clone needs those of "
            f"{LEAST_HELD_OUT + 1} at least, as {LEAST_HELD_OUT} are held out"
        )
    rng, known = np.random.default_rng(seed), sorted(pairs)
    while True:
        drawn = sorted(known[i] for i in rng.integers(len(known), size=len(known)))
        held_out = [name for name in known if name not in drawn]
        if len(held_out) >= LEAST_HELD_OUT:
            return Sample(tuple(drawn), tuple(held_out))
