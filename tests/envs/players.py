"""Agents for the tests of the environments."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import uniforms

TOMATO_KITCHEN = """
XXPXX
O1 2T
X   X
XDXSX
"""


class Wanderer:
    """Acts at random by its seeds, and keeps what it was told and shown."""

    def __init__(self, observation: str = "lossless26") -> None:
        self.observation = observation
        self.resets: list[tuple[str, NDArray[np.int64], NDArray[np.uint64]]] = []
        self.shown: list[Any] = []

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        self.resets.append((layout, seats.copy(), seeds.copy()))
        self._step = 0

    def act(self, observations: Any) -> NDArray[np.int64]:
        self.shown.append(observations)
        self._step += 1
        return (uniforms(self.resets[-1][2], self._step) * 6).astype(np.int64)


class Answers:
    """Gives one fixed answer, right or wrong."""

    observation = "features"

    def __init__(self, answer: Any) -> None:
        self._answer = answer

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        pass

    def act(self, observations: Any) -> Any:
        return self._answer
