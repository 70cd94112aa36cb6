"""Keys of random streams, from what they belong to."""

import hashlib


def stream_key(*parts: str | int) -> int:
    """Gives a 64-bit key that depends on the parts alone, never on what else is played or by which version of numpy.

    Args:
        parts: Texts and whole numbers; ("a", 1) and ("a1",) and ("a", "1") differ.
    """
    digest = hashlib.sha256(repr(tuple(parts)).encode()).digest()
    return int.from_bytes(digest[:8], "little")
