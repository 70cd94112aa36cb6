"""Defines scripted partners: functions of a part of the kitchen and the time.

A behaviour has no memory, so interference cannot confuse it, and a search can ask it about any state.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Final, Literal

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import UnknownLayout
from overcooked_bench.agents.mirror import mirror_actions, mirror_state
from overcooked_bench.kitchen.codes import RECIPES, Position
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import Chef, KitchenState, Soup

Content = Literal["onion", "tomato", "dish", "soup", "cooking", "ready"] | int | None
"""Content of a chef's hands, a counter or a pot; a number counts the ingredients of a pot that is not cooking."""

_REMEMBERED: Final = 1 << 16


@dataclass(frozen=True)
class Sight:
    """Lists what a behaviour depends on besides its own chef and the time.

    Attributes:
        pots: The content of all pots, but not the remaining cook time.
        counters: The content of these counters.
        partner: The other chef's cell.
        partner_facing: The other chef's direction.
    """

    pots: bool = False
    counters: frozenset[Position] = frozenset()
    partner: bool = False
    partner_facing: bool = False

    def __or__(self, other: "Sight") -> "Sight":
        return Sight(
            self.pots or other.pots,
            self.counters | other.counters,
            self.partner or other.partner,
            self.partner_facing or other.partner_facing,
        )


@dataclass(frozen=True)
class Scene:
    """Holds what a behaviour sees.

    Attributes:
        layout: The kitchen's.
        position: Own cell (x, y).
        facing: Own direction, "north" to "west".
        holding: The object in its own hands.
        partner: The other chef's cell, None if the behaviour does not depend on it.
        partner_facing: The other chef's direction, None if the behaviour does not depend on it.
        contents: ((x, y), content) of the pots and counters in sight, in row-major order.
        time: Steps since the start, or an earlier equivalent time, see `Behaviour.phase`.
    """

    layout: Layout
    position: Position
    facing: str
    holding: Content
    partner: Position | None
    partner_facing: str | None
    contents: tuple[tuple[Position, Content], ...]
    time: int

    def content(self, position: Position) -> Content:
        """Returns the content of the pot or counter at (x, y), which must be in sight."""
        return dict(self.contents)[position]


class Behaviour(ABC):
    """A scripted partner. Subclasses are frozen dataclasses, which compare equal if they behave identically."""

    @property
    def sight(self) -> Sight:
        """Returns what its action depends on."""
        return Sight()

    def phase(self, t: int) -> int:
        """Returns the earliest time after which it behaves as after t; always 0 if it does not depend on the time."""
        return 0

    @abstractmethod
    def decide(self, scene: Scene) -> int:
        """Chooses an action for a scene."""

    def act(self, layout: Layout, state: KitchenState, seat: int, t: int) -> int:
        """Chooses an action.

        Args:
            layout: The kitchen's.
            state: A legal state of it.
            seat: The partner's own, 0 or 1.
            t: Steps since the start of the scenario, not the state's own timestep.

        Returns:
            0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact.
        """
        return _decision(self, look(self.sight, layout, state, seat, self.phase(t)))

    def check(self, layout: Layout) -> None:
        """Checks that it can play a layout.

        Raises:
            UnknownLayout: A cell that it walks to is not floor there, or a counter that it uses is not a counter.
        """
        for cells, tile, what in ((self.sight.counters, "X", "counter"), (self.floor, " ", "floor")):
            wrong = sorted(set(cells) - set(layout.positions(tile)))
            if wrong:
                raise UnknownLayout(f"{wrong[0]} is no {what} of {layout.name!r}")

    @property
    def floor(self) -> frozenset[Position]:
        """Returns the floor cells that it refers to."""
        return frozenset()

    def mirrored(self, width: int) -> "Behaviour":
        """Returns the behaviour that does the same in the mirror image of its kitchen, which is `width` cells wide."""
        return Mirrored(self, width)


@dataclass(frozen=True)
class Mirrored(Behaviour):
    """Does in the mirrored kitchen what another behaviour does in the plain one, ties included."""

    plain: Behaviour
    width: int

    @property
    def sight(self) -> Sight:
        """Returns the mirrored sight."""
        plain = self.plain.sight
        return replace(plain, counters=frozenset((self.width - 1 - x, y) for x, y in plain.counters))

    @property
    def floor(self) -> frozenset[Position]:
        """Returns the mirrored cells."""
        return frozenset((self.width - 1 - x, y) for x, y in self.plain.floor)

    def phase(self, t: int) -> int:
        """Returns the plain behaviour's phase."""
        return self.plain.phase(t)

    def decide(self, scene: Scene) -> int:
        """Asks the plain behaviour about the mirrored scene."""
        other = Chef(scene.partner or (0, 0), scene.partner_facing or "north")
        seen = KitchenState((Chef(scene.position, scene.facing), other))
        me, partner = mirror_state(seen, self.width).chefs
        turned = replace(
            scene,
            layout=_mirrored(scene.layout),
            position=me.position,
            facing=me.facing,
            partner=scene.partner and partner.position,
            partner_facing=scene.partner_facing and partner.facing,
            contents=tuple(
                sorted((((self.width - 1 - x, y), what) for (x, y), what in scene.contents), key=lambda e: e[0][::-1])
            ),
        )
        return int(mirror_actions(_decision(self.plain, turned)))

    def mirrored(self, width: int) -> Behaviour:
        """Returns the plain behaviour."""
        return self.plain


def look(sight: Sight, layout: Layout, state: KitchenState, seat: int, time: int) -> Scene:
    """Returns what a behaviour sees from a seat."""
    me, partner = state.chefs[seat], state.chefs[1 - seat]
    seen = sorted({*(layout.positions("P") if sight.pots else ()), *sight.counters}, key=lambda cell: cell[::-1])
    return Scene(
        layout,
        me.position,
        me.facing,
        "soup" if isinstance(me.holding, Soup) else me.holding,
        partner.position if sight.partner else None,
        partner.facing if sight.partner_facing else None,
        tuple((cell, _content(layout, state, cell)) for cell in seen),
        time,
    )


class ScriptAgent:
    """Plays a behaviour as an agent; all rows start their clocks with `reset`.

    Args:
        behaviour: The behaviour to play.
    """

    observation = "state"

    def __init__(self, behaviour: Behaviour) -> None:
        self._behaviour = behaviour
        self._layout: Layout | None = None
        self._seats: list[int] = []
        self._step = 0

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts new episodes.

        Raises:
            LayoutError: No such layout.
            UnknownLayout: The behaviour refers to cells that this layout does not have.
        """
        if self._layout is None or layout != self._layout.name:
            self._layout = Layout.load(layout)
        self._behaviour.check(self._layout)
        self._seats, self._step = [int(seat) for seat in seats], 0

    def act(self, observations: Sequence[KitchenState]) -> NDArray[np.int64]:
        """Chooses one action per row."""
        assert self._layout is not None
        t, layout, self._step = self._step, self._layout, self._step + 1
        rows = zip(observations, self._seats, strict=True)
        return np.array([self._behaviour.act(layout, state, seat, t) for state, seat in rows], np.int64)


def _content(layout: Layout, state: KitchenState, cell: Position) -> Content:
    thing = state.objects.get(cell)
    if not isinstance(thing, Soup):
        return 0 if thing is None and layout.tile(cell) == "P" else thing
    if layout.tile(cell) != "P":
        return "soup"
    if thing.is_idle:
        return sum(thing.recipe)
    return "ready" if thing.tick >= layout.cook_times[RECIPES.index(thing.recipe)] else "cooking"


@lru_cache(_REMEMBERED)
def _decision(behaviour: Behaviour, scene: Scene) -> int:
    return behaviour.decide(scene)


@lru_cache(64)
def _mirrored(layout: Layout) -> Layout:
    return layout.mirrored()
