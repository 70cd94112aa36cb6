"""`conduct`: what people or agents do in their games on one layout, as numbers that can be compared."""

from collections.abc import Callable, Iterable, Sequence
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.errors import WrongUse
from overcooked_bench.estimate import Estimate, ratio_interval
from overcooked_bench.human.game import Game
from overcooked_bench.human.tracks import follow
from overcooked_bench.kitchen.codes import STAY, Position
from overcooked_bench.kitchen.layout import Layout, layout_names
from overcooked_bench.kitchen.tracks.counts import DEEDS, Counts, count
from overcooked_bench.kitchen.tracks.ring import find_middle

PER = 400
"""Steps that events are counted per: the length of an episode."""


class ChefConduct(msgspec.Struct, frozen=True):
    """What one of the two chefs does.

    Attributes:
        actions: Share of its steps with each of the six actions.
        events: How often it does each of `counts.DEEDS`, per 400 steps.
        hands_over: How often it puts something on a counter that the other chef picks up, per 400 steps.
        stuck: Share of its steps in which its action was a direction, and it was on the same cell and faced the same
            way afterwards: the other chef, or a counter that it faced already, was in the way.
        blocked: Share of its steps in which the other chef kept it out of a floor cell, whether it turned or not.
        clockwise: As in `Conduct`, of this chef.
        laps: Its laps clockwise and anticlockwise per 400 steps, in the same sense; None without a ring.
        visits: Share of its time on each cell, [y][x].
    """

    actions: tuple[float, ...]
    events: dict[str, float]
    hands_over: float
    stuck: float
    blocked: float
    clockwise: float | None
    laps: tuple[float, float] | None
    visits: tuple[tuple[float, ...], ...]

    @property
    def idle(self) -> float:
        """Share of its steps with the action stay."""
        return self.actions[STAY]


class HandedOver(msgspec.Struct, frozen=True):
    """Objects that change hands over one counter.

    Attributes:
        counter: (x, y).
        item: "onion", "tomato", "dish" or "soup".
        share: Share of all hand-overs on the layout.
        rates: How often chef 0 and chef 1 hand it over here, per 400 steps.
    """

    counter: Position
    item: str
    share: float
    rates: tuple[float, float]


class Conduct(msgspec.Struct, frozen=True):
    """What both chefs do in games on one layout. Intervals are over pairs of people.

    Attributes:
        layout: Its name, or its grid.
        games: How many games.
        pairs: How many groups of people played them; 0 if a game does not say.
        steps: Joint steps of all games.
        soups: Soups delivered per 400 steps.
        points: Points per 400 steps, as this layout pays.
        idle: Share of the chefs' steps with the action stay.
        stuck: Share of the chefs' steps in which they were stuck, see `ChefConduct.stuck`.
        blocked: Share of the chefs' steps in which they were blocked, see `ChefConduct.blocked`.
        hand_overs: Hand-overs per 400 steps: objects that one chef puts on a counter, and that the other chef is the
            next to pick up from there.
        clockwise: Share of the way around the kitchen's middle that is walked clockwise, as seen from above; walking
            to and fro cancels out within 100 steps. None without a ring, or if nobody walks around it.
        handed: Every counter and object, the most frequent first.
        chefs: What chef 0 and chef 1 do.
    """

    layout: str
    games: int
    pairs: int
    steps: int
    soups: Estimate
    points: Estimate
    idle: Estimate
    stuck: Estimate
    blocked: Estimate
    hand_overs: Estimate
    clockwise: Estimate | None
    handed: tuple[HandedOver, ...]
    chefs: tuple[ChefConduct, ChefConduct]

    @property
    def actions(self) -> tuple[float, ...]:
        """Share of both chefs' steps with each of the six actions."""
        return tuple(np.mean([chef.actions for chef in self.chefs], axis=0).tolist())

    @property
    def handovers(self) -> dict[tuple[Position, str], float]:
        """(counter, object) -> share of all hand-overs; empty if there are none."""
        return {(entry.counter, entry.item): entry.share for entry in self.handed}

    @property
    def visits(self) -> NDArray[np.float64]:
        """(2, H, W) share of each chef's time by cell."""
        return np.array([chef.visits for chef in self.chefs])


def conduct(games: Sequence[Game]) -> Conduct:
    """Plays games of one layout again and describes what the chefs do in them.

    Args:
        games: One at least. An interval needs games of two groups of people, and no game without a group.

    Raises:
        WrongUse: No games, several layouts, or a game that cannot be played.
    """
    layouts = {game.layout for game in games}
    if len(layouts) != 1:
        given = f"games on {', '.join(map(repr, sorted(layouts)))}" if layouts else "no games"
        raise WrongUse(f"conduct of {given}; give games of one layout, or use conducts(games)")
    total, by_group = None, dict[str | None, Counts]()
    for game, track in zip(games, follow(games), strict=True):
        counts = count(game.kitchen, track)
        total = counts if total is None else total + counts
        by_group[game.group] = by_group[game.group] + counts if game.group in by_group else counts
    assert total is not None
    return _described(games[0].kitchen, total, [] if None in by_group else list(by_group.values()))


def conducts(
    games: Sequence[Game], on_progress: Callable[[str, int, int], None] = lambda what, done, of: None
) -> list[Conduct]:
    """Describes games of any layouts: one `Conduct` per layout, shipped layouts first, in the order of `list`.

    Args:
        games: Any number.
        on_progress: Called per layout with its name, how many are done, and how many there are.

    Raises:
        WrongUse: A game cannot be played.
    """
    shipped = layout_names()
    layouts = sorted({game.layout for game in games})
    layouts.sort(key=lambda name: shipped.index(name) if name in shipped else len(shipped))
    found = []
    for done, layout in enumerate(layouts, start=1):
        found.append(conduct([game for game in games if game.layout == layout]))
        on_progress(layout, done, len(layouts))
    return found


def as_json(found: Sequence[Conduct]) -> bytes:
    """Returns descriptions as indented JSON: a list of `Conduct`, as it is read with msgspec."""
    return msgspec.json.format(msgspec.json.encode(found), indent=2) + b"\n"


def _described(layout: Layout, total: Counts, pairs: Sequence[Counts]) -> Conduct:
    """Turns sums into shares and rates; intervals are over pairs."""
    units = pairs or [total]
    steps = [unit.steps for unit in units]

    def rate(amounts: Iterable[Any], per: float = PER) -> Estimate:
        return ratio_interval(per * np.array(list(amounts), np.float64), steps, lowest=0.0)

    def share(amounts: Iterable[Any]) -> Estimate:
        return ratio_interval(np.array(list(amounts), np.float64) / 2, steps, lowest=0.0, highest=1.0)

    around = np.array([unit.laps.sum(axis=0) for unit in units])
    deliveries = list(DEEDS).index("deliveries")
    first, second = (_chef(total, chef, find_middle(layout) is not None) for chef in range(2))
    return Conduct(
        layout=layout.name,
        games=total.games,
        pairs=len(pairs),
        steps=total.steps,
        soups=rate(unit.deeds[:, deliveries].sum() for unit in units),
        points=rate(unit.points.sum() for unit in units),
        idle=share(unit.actions[:, STAY].sum() for unit in units),
        stuck=share(unit.stuck.sum() for unit in units),
        blocked=share(unit.blocked.sum() for unit in units),
        hand_overs=rate(sum(unit.handed.values()) for unit in units),
        clockwise=ratio_interval(around[:, 0], around.sum(axis=1), 0.0, 1.0) if around.any() else None,
        handed=_handed(total),
        chefs=(first, second),
    )


def _chef(total: Counts, chef: int, ring: bool) -> ChefConduct:
    per, around = PER / total.steps, total.laps[chef]
    return ChefConduct(
        actions=tuple((total.actions[chef] / total.steps).tolist()),
        events=dict(zip(DEEDS, (total.deeds[chef] * per).tolist(), strict=True)),
        hands_over=per * sum(times for (_, _, giver), times in total.handed.items() if giver == chef),
        stuck=float(total.stuck[chef] / total.steps),
        blocked=float(total.blocked[chef] / total.steps),
        clockwise=float(around[0] / around.sum()) if around.any() else None,
        laps=(float(around[0] * per), float(around[1] * per)) if ring else None,
        visits=tuple(tuple(row) for row in (total.visits[chef] / total.steps).tolist()),
    )


def _handed(total: Counts) -> tuple[HandedOver, ...]:
    all_of_them, per = sum(total.handed.values()), PER / total.steps
    places = {(cell, item) for cell, item, _ in total.handed}
    found = []
    for cell, item in places:
        times = [total.handed[cell, item, giver] for giver in range(2)]
        found.append(HandedOver(cell, item, sum(times) / all_of_them, (times[0] * per, times[1] * per)))
    return tuple(sorted(found, key=lambda entry: (-entry.share, entry.counter, entry.item)))
