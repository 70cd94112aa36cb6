"""Locks folders, so that one process at a time works in each."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def locked(folder: Path, wait: bool = True) -> Iterator[bool]:
    """Keeps other processes out of a folder, where the system can.

    Args:
        folder: Is made.
        wait: Whether to wait for others to leave it.

    Yields:
        Whether it is ours.
    """
    folder.mkdir(parents=True, exist_ok=True)
    try:
        import fcntl
    except ImportError:  # Windows
        yield True
        return
    held = os.open(folder, os.O_RDONLY)
    try:
        try:
            fcntl.flock(held, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
            ours = True
        except BlockingIOError:
            ours = False
        yield ours
    finally:
        os.close(held)


@contextmanager
def alone(folder: Path) -> Iterator[None]:
    """Waits until no other process works in a folder, and says so where there is one."""
    with locked(folder, wait=False) as ours:
        if ours:
            yield
            return
    print(f"{folder}: another process trains there; waiting for it to end", file=sys.stderr)
    with locked(folder):
        yield
