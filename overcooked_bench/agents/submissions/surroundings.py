"""Keeps an agent's code from changing what all code of a process shares."""

import sys
from typing import Any

import numpy as np


class Surroundings:
    """Puts global settings of numpy and torch back when an agent's code is done.

    These are numpy's floating-point error handling, and torch's default type, default device, gradient mode and number
    of threads. A setting that is changed here by one agent would change what its partners compute.
    """

    def __enter__(self) -> None:
        torch = sys.modules.get("torch")
        self._numpy = np.geterr()
        self._torch = _settings(torch) if torch else None

    def __exit__(self, *_: object) -> None:
        if np.geterr() != self._numpy:
            np.seterr(**self._numpy)
        torch = sys.modules.get("torch")
        if torch and self._torch and _settings(torch) != self._torch:
            dtype, device, gradients, threads = self._torch
            torch.set_default_dtype(dtype)
            torch.set_default_device(device)
            torch.set_grad_enabled(gradients)
            torch.set_num_threads(threads)


def _settings(torch: Any) -> tuple[Any, ...]:
    return torch.get_default_dtype(), torch.get_default_device(), torch.is_grad_enabled(), torch.get_num_threads()
