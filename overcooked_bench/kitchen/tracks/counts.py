"""Counts what two chefs do in a game, from the arrays of its track.

Axes: T steps, H rows, W columns, D deeds.
"""

from collections import Counter
from dataclasses import dataclass, fields
from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import (
    BLOCKED,
    DIRECTIONS,
    DISH,
    NUM_ACTIONS,
    ONION,
    PICKED_UP,
    PLATED,
    POTTED,
    PUT_DOWN,
    SERVED,
    STARTED,
    STAY,
    TOMATO,
    TOOK,
    TOOK_DISH,
    Position,
    item_of,
)
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.tracks.ring import find_middle, laps
from overcooked_bench.kitchen.tracks.track import Track

DEEDS: Final = {
    "ingredients": (TOOK | TOOK_DISH, TOOK),
    "dishes": (TOOK_DISH, TOOK_DISH),
    "pots": (POTTED, POTTED),
    "starts": (STARTED, STARTED),
    "plates": (PLATED, PLATED),
    "deliveries": (SERVED, SERVED),
    "counter_drops": (PUT_DOWN, PUT_DOWN),
    "counter_pickups": (PICKED_UP, PICKED_UP),
}
"""Events by name: ingredients and dishes taken out of a dispenser, ingredients put into a pot, pots started by hand,
soups taken out of a pot, soups delivered, objects put on a counter and picked up from one; with the bits of
`StepResult.actions_taken` that are looked at, and what they have to be."""

_MASKS, _WANTED = np.array(list(DEEDS.values()), np.uint16).T
_DIRECTIONS: Final = np.array(DIRECTIONS)
_ITEMS: Final = {ONION: "onion", TOMATO: "tomato", DISH: "dish"}

HandOver = tuple[Position, str, int]
"""The counter's cell, the object ("onion", "tomato", "dish" or "soup"), and the chef that put it down."""


@dataclass(frozen=True)
class Counts:
    """Sums over games of one layout; the first axis of each array is the chef.

    Attributes:
        games: How many games.
        steps: Their joint steps.
        points: (2,) points of the soups that each delivered.
        actions: (2, 6) steps with each action.
        deeds: (2, D) how often each of `DEEDS` was done.
        stuck: (2,) steps with a direction as action that left the chef on the same cell, facing the same way.
        blocked: (2,) steps in which the other chef kept it out of a floor cell.
        laps: (2, 2) see `ring.laps`; zeros where the layout has no ring.
        visits: (2, H, W) steps that began with the chef on each cell.
        handed: How often each hand-over happened. Handed over is what one chef puts on a counter and the other chef is
            the next to pick up from there.
    """

    games: int
    steps: int
    points: NDArray[np.float64]
    actions: NDArray[np.int64]
    deeds: NDArray[np.int64]
    stuck: NDArray[np.int64]
    blocked: NDArray[np.int64]
    laps: NDArray[np.float64]
    visits: NDArray[np.int64]
    handed: Counter[HandOver]

    def __add__(self, other: "Counts") -> "Counts":
        """Counts of the games of both."""
        return Counts(*(getattr(self, field.name) + getattr(other, field.name) for field in fields(self)))


def count(layout: Layout, track: Track) -> Counts:
    """Counts what happened in one game."""
    steps, cells, facing = len(track.actions), track.cells.astype(np.int64), track.facing.astype(np.int64)
    actions, before = track.actions.astype(np.int64), cells[:-1]
    middle = find_middle(layout)
    still = (cells[1:] == before) & (facing[1:] == facing[:-1])
    done = (track.taken[..., None] & _MASKS) == _WANTED
    return Counts(
        games=1,
        steps=steps,
        points=track.points,
        actions=_histograms(actions, NUM_ACTIONS),
        deeds=done.sum(axis=0),
        stuck=(still & (actions < STAY)).sum(axis=0),
        blocked=(track.taken & BLOCKED != 0).sum(axis=0),
        laps=np.zeros((2, 2)) if middle is None else laps(cells % layout.width, cells // layout.width, middle),
        visits=_histograms(before, layout.width * layout.height).reshape(2, layout.height, layout.width),
        handed=_hand_overs(layout, before, facing[:-1], track.taken),
    )


def _histograms(values: NDArray[np.int64], size: int) -> NDArray[np.int64]:
    return np.stack([np.bincount(values[:, chef], minlength=size) for chef in range(2)])


def _hand_overs(
    layout: Layout, cells: NDArray[np.int64], facing: NDArray[np.int64], taken: NDArray[np.uint16]
) -> Counter[HandOver]:
    """Follows each object on a counter from the chef that put it there to the chef that picks it up."""
    faced, items = (
        np.stack([cells % layout.width, cells // layout.width], axis=-1) + _DIRECTIONS[facing],
        item_of(taken),
    )
    found: Counter[HandOver] = Counter()
    put_by: dict[Position, int] = {}
    for step, chef in np.argwhere(taken & (PUT_DOWN | PICKED_UP)).tolist():  # by step, then chef: as in the game
        x, y = faced[step, chef].tolist()
        if taken[step, chef] & PUT_DOWN:
            put_by[x, y] = chef
        elif put_by.pop((x, y), chef) != chef:
            found[(x, y), _ITEMS.get(int(items[step, chef]), "soup"), 1 - chef] += 1
    return found
