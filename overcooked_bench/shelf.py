"""Names that are looked up: a guess at what was meant."""

import difflib
from collections.abc import Iterable


def guess(given: object, known: Iterable[str], most: int = 1, cutoff: float = 0.4) -> str:
    """Gives "did you mean 'greedy'? ", with a space at the end, for a message; an empty text if nothing is near.

    Args:
        given: What was written.
        known: The names that exist.
        most: How many guesses to give.
        cutoff: How near a guess has to be, from 0 to 1, as in `difflib.get_close_matches`.
    """
    near = difflib.get_close_matches(str(given), list(known), n=most, cutoff=cutoff)
    return f"did you mean {' or '.join(map(repr, near))}? " if near else ""
