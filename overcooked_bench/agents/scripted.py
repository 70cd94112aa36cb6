"""The scripted agents: `stay`, `random`, two couriers that do half the work each, `greedy`, and planners with habits.

A new one is a file with its class, and a row in `SCRIPTED`.

Axes: B rows (simultaneous episodes).
"""

import hashlib
from collections.abc import Callable
from functools import partial
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent
from overcooked_bench.agents.draws import sample_actions
from overcooked_bench.agents.planner.habits import Habits
from overcooked_bench.agents.planner.planner import Planner
from overcooked_bench.kitchen.codes import NUM_ACTIONS, STAY
from overcooked_bench.kitchen.layout import Layout


class Scripted(NamedTuple):
    """A scripted agent.

    Attributes:
        factory: Makes one for a layout: a shipped name, a grid's text, a file or a Layout.
        version: Raise it when the agent's behaviour changes: scores against different versions are not comparable.
        what: What it does, in a few words, for lists.
    """

    factory: Callable[[str | Layout], Agent]
    version: int = 1
    what: str = ""


class _Simple:
    """An agent that needs no plan."""

    observation = "lossless26"

    def __init__(self, layout: str | Layout) -> None:
        self._seeds: NDArray[np.uint64] = np.zeros(0, np.uint64)
        self._step = 0

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts new episodes."""
        self._seeds, self._step = np.asarray(seeds, np.uint64), 0


class Stay(_Simple):
    """Never moves."""

    def act(self, observations: Any) -> NDArray[np.int64]:
        """Stays, in every row."""
        return np.full(len(self._seeds), STAY)


class Random(_Simple):
    """Draws each of the six actions with the same probability."""

    def act(self, observations: Any) -> NDArray[np.int64]:
        """Draws one action per row."""
        self._step += 1
        uniform = np.full((len(self._seeds), NUM_ACTIONS), 1 / NUM_ACTIONS)
        return sample_actions(uniform, self._seeds, self._step - 1)


def _greedy(habits: Habits, what: str, version: int = 1) -> Scripted:
    return Scripted(partial(Planner, "greedy", habits=habits), version, what)


SCRIPTED: Final[dict[str, Scripted]] = {
    "stay": Scripted(Stay, what="never moves"),
    "random": Scripted(Random, what="draws each action with the same probability"),
    "onion_courier": Scripted(partial(Planner, "onion_courier"), what="only brings ingredients to pots"),
    "dish_courier": Scripted(partial(Planner, "dish_courier"), what="only fetches dishes, plates and serves"),
    "greedy": Scripted(partial(Planner, "greedy"), what="does whatever is most useful at the moment"),
    "hesitant": _greedy(
        Habits(pause=0.35, food_over="middle", dish_over="bottom"),
        "greedy, but does nothing in every third step; hands onions over in the middle, dishes at the bottom",
    ),
    "counter_passer": _greedy(
        Habits(job="food", passes=True, food_over="middle", dish_over="top"),
        "passes objects over counters and leaves plates to others; hands onions over in the middle, dishes at the top",
    ),
    "clockwise": _greedy(
        Habits(job="early", turn=1, food_over="top", dish_over="bottom"),
        "walks clockwise and fetches dishes early; hands onions over at the top, dishes at the bottom",
    ),
    "anticlockwise": _greedy(
        Habits(turn=-1, food_over="bottom", dish_over="top"),
        "walks anticlockwise; hands onions over at the bottom, dishes at the top",
    ),
    "waiter": _greedy(
        Habits(job="dish", food_over="top", dish_over="middle"),
        "plates and serves, cooks only if the partner does not; hands onions over at the top, dishes in the middle",
        version=2,
    ),
    "plates_first": _greedy(
        Habits(job="early", passes=True, pause=0.2, food_over="bottom", dish_over="middle"),
        "fetches dishes early, passes over counters, pauses in every fifth step; hands onions over at the bottom, "
        "dishes in the middle",
        version=2,
    ),
}
"""The scripted agents by name."""


def scripted_sha256(name: str, version: int) -> str:
    """Computes the hash of a scripted agent, which other agents have of their weights."""
    return hashlib.sha256(f"scripted/{name}/{version}".encode()).hexdigest()
