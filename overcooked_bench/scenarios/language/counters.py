"""What chefs have done so far, counted: every event belongs to the chef whose interaction it was.

Axes: N kitchens (rows), K counters.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import CELLS, FACING, HELD, POSITION
from overcooked_bench.kitchen.codes import (
    DISH,
    FLOOR,
    INTERACT,
    NOTHING,
    ONION,
    POT_IDLE,
    SERVING,
    SOUP,
    STAY,
    TOMATO,
)

if TYPE_CHECKING:
    from overcooked_bench.kitchen.tables import Tables

ITEMS: Final = {"nothing": NOTHING, "onion": ONION, "tomato": TOMATO, "dish": DISH, "soup": SOUP + 1}
"""Things by name; every soup counts as the code after SOUP."""

EVENTS: Final = ("pot", "plate", "serve", "pick", "drop")
"""What an interaction can be: fill a pot, take a soup out of a pot with a dish, deliver, take from a dispenser or a
counter, put on a counter."""

_POT, _PLATE, _SERVE, _PICK, _DROP = range(1, len(EVENTS) + 1)
_AHEAD, _WANTED = 0, 4  # columns of Tables.ways


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
    before: NDArray[np.uint16],
    after: NDArray[np.uint16],
    actions: NDArray[np.int64],
) -> NDArray[np.int64]:
    """Counts what one joint step brought.

    Args:
        counters: K of them.
        seats: (N,) int64, the seat of chef A in each kitchen.
        tables: The kitchens' tables.
        before: (N, ...) rows of the batch before the step.
        after: (N, ...) rows after it.
        actions: (N, 2) int64 the joint actions.

    Returns:
        (N, K) int64, what is to be added to each counter.
    """
    increments = np.zeros((len(before), len(counters)), np.int64)
    if not counters:
        return increments
    what, things, ahead = _events(tables, before, after, actions)
    for k, counter in enumerate(counters):
        if counter.event == "score":
            increments[:, k] = np.where(what == _SERVE, tables.payments[0][before[:, HELD:CELLS]], 0).sum(axis=1)
            continue
        chef = (seats if counter.chef == "A" else 1 - seats)[:, None]
        if counter.event == "blocked":
            increments[:, k] = np.take_along_axis(_blocked(tables, before, after, actions), chef, axis=1)[:, 0]
            continue
        hit = what == EVENTS.index(counter.event) + 1
        if counter.item is not None:
            hit = hit & (things == ITEMS[counter.item])
        if counter.at is not None:
            hit = hit & (ahead == tables.pots[counter.at - 1])
        increments[:, k] = np.take_along_axis(hit, chef, axis=1)[:, 0]
    return increments


def _events(
    tables: "Tables", before: NDArray[np.uint16], after: NDArray[np.uint16], actions: NDArray[np.int64]
) -> tuple[NDArray[np.uint8], NDArray[np.uint16], NDArray[np.uint16]]:
    """Gives (N, 2) what each chef did (0 for nothing), with which thing, and the cell that it faced."""
    ahead = tables.ways[before[:, POSITION:FACING], _AHEAD + before[:, FACING:HELD]]
    had, has = kinds(before[:, HELD:CELLS]), kinds(after[:, HELD:CELLS])
    tile = tables.fresh[ahead]
    gave, took = (had != NOTHING) & (has == NOTHING), (had == NOTHING) & (has != NOTHING)
    what = np.zeros(had.shape, np.uint8)
    what[took] = _PICK
    what[gave] = _DROP
    what[gave & (tile == POT_IDLE)] = _POT
    what[gave & (tile == SERVING)] = _SERVE
    what[(had == DISH) & (has == SOUP + 1)] = _PLATE
    what[actions != INTERACT] = 0
    return what, np.where(took, has, had), ahead


def _blocked(
    tables: "Tables", before: NDArray[np.uint16], after: NDArray[np.uint16], actions: NDArray[np.int64]
) -> NDArray[np.bool_]:
    """Tells (N, 2) who wanted to walk to another floor cell and did not get there."""
    here, there = before[:, POSITION:FACING], after[:, POSITION:FACING]
    wanted = tables.ways[here, _WANTED + actions]
    return np.asarray((actions < STAY) & (wanted != here) & (there == here) & (tables.fresh[wanted] == FLOOR))
