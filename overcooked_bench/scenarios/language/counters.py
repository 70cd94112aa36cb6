"""Counts what chefs have done so far: every event belongs to the chef that interacted.

Axes: N kitchens (rows), K counters.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import (
    BLOCKED,
    DISH,
    NOTHING,
    ONION,
    PICKED_UP,
    PLATED,
    POTTED,
    PUT_DOWN,
    SERVED,
    SOUP,
    TOMATO,
    TOOK,
    item_of,
)

if TYPE_CHECKING:
    from overcooked_bench.kitchen.tables import Tables

ITEMS: Final = {"nothing": NOTHING, "onion": ONION, "tomato": TOMATO, "dish": DISH, "soup": SOUP + 1}
"""Objects by name; every soup counts as the code after SOUP."""

EVENTS: Final = {"pot": POTTED, "plate": PLATED, "serve": SERVED, "pick": TOOK | PICKED_UP, "drop": PUT_DOWN}
"""The kinds of interaction: fill a pot, take a soup out of a pot with a dish, deliver, take from a dispenser or a
counter, put on a counter; with its bits in `StepResult.actions_taken`."""


@dataclass(frozen=True)
class Counter:
    """Something that a scenario counts.

    Attributes:
        event: One of `EVENTS`; "blocked" for the steps in which a chef wanted to walk and the other was in the way; or
            "score" for the team's points.
        chef: "A" or "B"; empty for the score.
        item: Only with this object.
        at: Only at this pot, numbered from 1 in reading order.
    """

    event: str
    chef: str = ""
    item: str | None = None
    at: int | None = None

    def __str__(self) -> str:
        """The counter in the language of conditions."""
        if self.event == "score":
            return "score"
        if self.event == "blocked":
            return f"blocked({self.chef})"
        given = [part for part in (self.item, None if self.at is None else f"at={self.at}") if part]
        return f"{self.chef}.{self.event}" + (f"({', '.join(given)})" if given else "")


def kinds(items: NDArray[np.uint16]) -> NDArray[np.uint16]:
    """Returns the code of each object with all soups as one, as in `ITEMS`."""
    return np.minimum(items, np.uint16(SOUP + 1))


def count_step(
    counters: Sequence[Counter],
    seats: NDArray[np.int64],
    tables: "Tables",
    rows: NDArray[np.uint16],
    taken: NDArray[np.uint16],
) -> NDArray[np.int64]:
    """Counts the events of one joint step.

    Args:
        counters: K of them.
        seats: (N,) int64, the seat of chef A in each kitchen.
        tables: The kitchens' tables.
        rows: (N, ...) rows of the batch after the step; a chef that interacted faces the same cell as before.
        taken: (N, 2) uint16, the actions taken, see `StepResult.actions_taken`.

    Returns:
        (N, K) int64, the numbers to add to each counter.
    """
    increments = np.zeros((len(taken), len(counters)), np.int64)
    for k, counter in enumerate(counters):
        if counter.event == "score":
            increments[:, k] = np.where(taken & SERVED, tables.payments[0][item_of(taken)], 0).sum(axis=1)
            continue
        hit = taken & (BLOCKED if counter.event == "blocked" else EVENTS[counter.event]) != 0
        if counter.item is not None:
            hit &= kinds(item_of(taken)) == ITEMS[counter.item]
        if counter.at is not None:
            hit &= tables.faced(rows) == tables.pots[counter.at - 1]
        chef = (seats if counter.chef == "A" else 1 - seats)[:, None]
        increments[:, k] = np.take_along_axis(hit, chef, axis=1)[:, 0]
    return increments
