"""The axes along which two chefs must agree on each classic layout, and how games show where an agent is on them.

An axis counts, for each of its values, what speaks for it; `AXES` has those of each layout.
"""

from collections.abc import Callable, Mapping
from typing import Final, NamedTuple

from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.regions import faced_from
from overcooked_bench.kitchen.tracks.counts import DEEDS, Counts

MIXED: Final = "mixed"
"""The value of an agent that does all of it, none of it in two thirds of the cases."""


class Seen(NamedTuple):
    """One game of an agent.

    Attributes:
        layout: Where.
        counts: What both chefs did.
        chefs: Which of them the agent was: both in a game with its own copy.
        sides: Region of the floor in which each chef started.
    """

    layout: Layout
    counts: Counts
    chefs: tuple[int, ...]
    sides: tuple[int, int]

    def deeds(self, name: str) -> list[int]:
        """Returns how often each of the two chefs did something of `DEEDS`."""
        done: list[int] = self.counts.deeds[:, _INDEX[name]].tolist()
        return done


class Axis(NamedTuple):
    """One axis.

    Attributes:
        name: What convention texts call it.
        meaning: What the agents must agree on, in words.
        values: Value -> what it means; `MIXED` is a value of every axis.
        speaks: Counts what speaks for each value in one game. Counts are added over games; a negative sum is none.
    """

    name: str
    meaning: str
    values: Mapping[str, str]
    speaks: Callable[[Seen], Mapping[str, float]]


_INDEX: Final = {name: i for i, name in enumerate(DEEDS)}
_HEIGHTS: Final = ("top", "middle", "bottom")


def _counter(item: str) -> Callable[[Seen], dict[str, float]]:
    def speaks(seen: Seen) -> dict[str, float]:
        """Counts the objects that changed hands, by the counter that both sides face."""
        layout, handed = seen.layout, seen.counts.handed
        shared = sorted(y for x, y in layout.positions("X") if len(faced_from((x, y), layout.regions)) > 1)
        by_height = {
            y: sum(times for (cell, what, _), times in handed.items() if what == item and cell[1] == y) for y in shared
        }
        return {height: by_height[y] for height, y in zip(_HEIGHTS, shared, strict=True)}

    return speaks


def _direction(seen: Seen) -> dict[str, float]:
    """Counts laps of the agent, and its share of the soups that were plated without one."""
    clockwise, anticlockwise = seen.counts.laps[list(seen.chefs)].sum(axis=0).tolist()
    soups = sum(seen.deeds("plates")) * len(seen.chefs) / 2
    return {
        "clockwise": clockwise,
        "anticlockwise": anticlockwise,
        "to and fro": soups - clockwise - anticlockwise,
    }


def _passing(seen: Seen) -> dict[str, float]:
    """Counts objects that changed hands over a counter, and soups that were plated without one."""
    handed = sum(seen.counts.handed.values())
    return {"passing": handed, "carrying": sum(seen.deeds("plates")) - handed}


def _serving(seen: Seen) -> dict[str, float]:
    """Counts the soups that the agent delivered, by its side."""
    found = {"left": 0.0, "right": 0.0}
    served = seen.deeds("deliveries")
    for chef in seen.chefs:
        found["right" if seen.sides[chef] else "left"] += served[chef]
    return found


def _plating(seen: Seen) -> dict[str, float]:
    """Counts pairs of soups of a game that one chef plated, beyond those that chance makes, and pairs by both chefs."""
    first, second = seen.deeds("plates")
    apart = first * second
    return {"one": (first * (first - 1) + second * (second - 1)) / 2 - apart, "both": 2 * apart}


_COUNTERS: Final = {height: f"two thirds pass the {height} counter" for height in _HEIGHTS}
_RING: Final = (
    Axis(
        "direction",
        "the direction in which chefs walk around the middle, seen from above",
        {
            "clockwise": "laps clockwise",
            "anticlockwise": "laps anticlockwise",
            "to and fro": "fewer laps than a third of the soups, net of the way back within 100 steps",
        },
        _direction,
    ),
    Axis(
        "transport",
        "whether objects change hands over a counter",
        {"passing": "two objects or more for three soups", "carrying": "one object or less for three soups"},
        _passing,
    ),
)

AXES: Final[Mapping[str, tuple[Axis, ...]]] = {
    "cramped_room": (
        Axis(
            "plates",
            "who puts the soups of a game on plates",
            {"one": "one chef nearly always", "both": "both, in turn or as it comes"},
            _plating,
        ),
    ),
    "asymmetric_advantages": (
        Axis(
            "serves",
            "which side's chef delivers",
            {"left": "the one near the left serving tile", "right": "the one near the right serving tile"},
            _serving,
        ),
    ),
    "coordination_ring": _RING,
    "forced_coordination": (
        Axis("onions", "the counter that onions pass", _COUNTERS, _counter("onion")),
        Axis("dishes", "the counter that dishes pass", _COUNTERS, _counter("dish")),
    ),
    "counter_circuit": _RING,
}
"""Layout -> its axes; layouts without a row have none."""
