"""What chefs have done so far, counted: every event belongs to the chef whose interaction it was.

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
"""Things by name; every soup counts as the code after SOUP."""

EVENTS: Final = {"pot": POTTED, "plate": PLATED, "serve": SERVED, "pick": TOOK | PICKED_UP, "drop": PUT_DOWN}
"""What an interaction can be: fill a pot, take a soup out of a pot with a dish, deliver, take from a dispenser or a
counter, put on a counter; with its bits in `StepResult.actions_taken`."""


@dataclass(frozen=True)
class Counter:
    """Something that a scenario counts.

    Attributes:
        event: One of `EVENTS`; "blocked" for the steps in which a chef wanted to walk and the other was in the way; or
            "score" for the team's points.
        chef: "A" or "B"; empty for the score.
        item: Only with this thing.
        at: Only at this pot, numbered from 1 in reading order.
    """

    event: str
    chef: str = ""
    item: str | None = None
    at: int | None = None

    def __str__(self) -> str:
        """As the language of conditions writes it."""
        if self.event == "score":
            return "score"
        if self.event == "blocked":
            return f"blocked({self.chef})"
        given = [part for part in (self.item, None if self.at is None else f"at={self.at}") if part]
        return f"{self.chef}.{self.event}" + (f"({', '.join(given)})" if given else "")


def kinds(items: NDArray[np.uint16]) -> NDArray[np.uint16]:
    """Gives the code of each thing with all soups as one, as in `ITEMS`."""
    return np.minimum(items, np.uint16(SOUP + 1))


def count_step(
    counters: Sequence[Counter],
    seats: NDArray[np.int64],
    tables: "Tables",
    rows: NDArray[np.uint16],
    taken: NDArray[np.uint16],
) -> NDArray[np.int64]:
    """Counts what one joint step brought.

    Args:
        counters: K of them.
        seats: (N,) int64, the seat of chef A in each kitchen.
        tables: The kitchens' tables.
        rows: (N, ...) rows of the batch after the step; whoever interacted faces what they faced before.
        taken: (N, 2) uint16, what each chef did, see `StepResult.actions_taken`.

    Returns:
        (N, K) int64, what is to be added to each counter.
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
