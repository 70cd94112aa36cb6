"""Seeds the global random generators, for submissions that draw from them."""

import random
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Final

import numpy as np

KEY: Final[ContextVar[int | None]] = ContextVar("KEY", default=None)
"""What the global generators were seeded with; agents in processes of their own seed theirs with it, too."""


def seed_generators(key: int) -> None:
    """Seeds the global generators of Python and numpy, and of torch if that is loaded."""
    random.seed(key)
    np.random.seed(key % 2**32)  # noqa: NPY002
    if (torch := sys.modules.get("torch")) is not None:
        torch.manual_seed(key)


@contextmanager
def seeded(key: int) -> Iterator[None]:
    """Seeds the global generators of Python, numpy and torch, and puts them back."""
    import torch

    states = random.getstate(), np.random.get_state(), torch.get_rng_state()  # noqa: NPY002
    seed_generators(key)
    before = KEY.set(key)
    try:
        yield
    finally:
        KEY.reset(before)
        random.setstate(states[0])
        np.random.set_state(states[1])  # noqa: NPY002
        torch.set_rng_state(states[2])
