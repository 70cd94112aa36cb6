"""Keeps settings that a submission's code changes in its process from all other code."""

import os
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from typing import Any

import numpy as np


class Surroundings:
    """The settings of the process as one submission has them.

    These are the working directory, numpy's handling of floating-point errors, and torch's default type, default device
    and gradient mode. They are in force while the submission's code runs; afterwards the process has its own again, and
    its own number of torch's threads too.
    """

    def __init__(self) -> None:
        self._theirs: dict[str, Any] = {}

    @contextmanager
    def inside(self) -> Iterator[None]:
        """Runs the submission's code with its settings."""
        threads = _threads()
        before = _settings()
        _put(before, self._theirs)
        try:
            yield
        finally:
            found = _settings()
            self._theirs = {name: value for name, value in found.items() if value != before.get(name, _FRESH.get(name))}
            _put(found, {**_FRESH, **before})
            if threads is not None and _threads() != threads:
                sys.modules["torch"].set_num_threads(threads)


_FRESH: dict[str, Any] = {"gradients": True}
"""Torch's settings if the submission is the first to load it; the others follow below."""


def _settings() -> dict[str, Any]:
    found: dict[str, Any] = {"numpy": np.geterr()}
    with suppress(OSError):  # the directory is gone
        found["directory"] = os.getcwd()
    torch = sys.modules.get("torch")
    if torch is not None:
        found["dtype"] = torch.get_default_dtype()
        found["device"] = str(torch.get_default_device())
        found["gradients"] = torch.is_grad_enabled()
        _FRESH.setdefault("dtype", torch.float32)
        _FRESH.setdefault("device", "cpu")
    return found


def _put(now: dict[str, Any], wanted: dict[str, Any]) -> None:
    """Changes those settings that differ."""
    torch = sys.modules.get("torch")
    for name, value in wanted.items():
        if now.get(name, value) == value:
            continue
        if name == "numpy":
            np.seterr(**value)
        elif name == "directory":
            with suppress(OSError):
                os.chdir(value)
        elif torch is not None:
            if name == "dtype":
                torch.set_default_dtype(value)
            elif name == "device":
                torch.set_default_device(None if value == "cpu" else value)
            else:
                torch.set_grad_enabled(value)


def _threads() -> int | None:
    torch = sys.modules.get("torch")
    return None if torch is None else int(torch.get_num_threads())
