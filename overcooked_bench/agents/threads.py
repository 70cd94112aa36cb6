"""Keeps torch on one thread, so that sums are formed in the same order everywhere."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def one_thread(load: bool = True) -> Iterator[None]:
    """Keeps torch on one thread within a `with` block.

    Args:
        load: Whether to load torch for that, which takes seconds; if torch is not loaded, nothing happens.
    """
    if not load and "torch" not in sys.modules:
        yield
        return
    import torch

    threads = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(threads)
