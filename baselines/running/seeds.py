"""Training seeds that cannot be shared by accident: each is a hash of what it is for.

A configuration is no part of it: runs of one method, layout and seed that differ in settings alone begin with the same
random numbers. They are one draw, not two, where seeds are what is averaged over.
"""

import hashlib
from typing import Final

USER: Final = "user"
"""The namespace of `--seed`; pools have namespaces of their own, so that no user's run equals a pool's agent."""


def derive_seed(namespace: str, layout: str, method: str, index: int) -> int:
    """Returns the 32-bit seed of one training run, from SHA-256 of (namespace, layout, method, index).

    Raises:
        ValueError: The namespace or the method has several lines, with which two runs could share one hash.
    """
    if "\n" in namespace + method:
        raise ValueError(f"namespace={namespace!r}, method={method!r}; give names of one line")
    text = "\n".join((namespace, layout, method, str(index)))
    return int.from_bytes(hashlib.sha256(text.encode()).digest()[:4], "big")


def restarted(seed: int, attempt: int) -> int:
    """Returns the seed of a run's `attempt`-th restart; attempt 0 is the run itself."""
    if not attempt:
        return seed
    return int.from_bytes(hashlib.sha256(f"{seed}\nrestart\n{attempt}".encode()).digest()[:4], "big")


def part_of(seed: int, part: str) -> int:
    """Returns the seed of a part of a run that consists of several, such as one agent of a population."""
    if "\n" in part:
        raise ValueError(f"part={part!r}; give a name of one line")
    return int.from_bytes(hashlib.sha256(f"{seed}\npart\n{part}".encode()).digest()[:4], "big")
