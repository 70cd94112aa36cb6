"""What a scripted partner is: it sees a part of the kitchen and the time, and always does the same where they are same.

A behaviour remembers nothing, so that whoever interferes cannot confuse it, and a search can ask it about any state.
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
"""What is in a chef's hands, on a counter or in a pot; a number counts the ingredients of a pot that does not cook."""

_REMEMBERED: Final = 1 << 16


@dataclass(frozen=True)
class Sight:
    """What a behaviour looks at besides its own chef and the time; whatever else changes, it does the same.

    Attributes:
        pots: What is in all pots, but not how long it still cooks.
        counters: What lies on these counters.
        mate: Where the other chef stands.
        mate_facing: Where the other chef looks.
    """

    pots: bool = False
    counters: frozenset[Position] = frozenset()
    mate: bool = False
    mate_facing: bool = False

    def __or__(self, other: "Sight") -> "Sight":
        return Sight(
            self.pots or other.pots,
            self.counters | other.counters,
            self.mate or other.mate,
            self.mate_facing or other.mate_facing,
        )


@dataclass(frozen=True)
class Scene:
    """What a behaviour sees.

    Attributes:
        layout: The kitchen's.
        position: Own cell (x, y).
        facing: Own direction, "north" to "west".
        holding: What is in the own hands.
        mate: The other chef's cell, None where it is not looked at.
        mate_facing: The other chef's direction, None where it is not looked at.
        contents: ((x, y), content) of the pots and counters that are looked at, in row-major order.
        time: Steps since the start, or an earlier time that is as good, see `Behaviour.phase`.
    """

    layout: Layout
    position: Position
    facing: str
    holding: Content
    mate: Position | None
    mate_facing: str | None
    contents: tuple[tuple[Position, Content], ...]
    time: int

    def content(self, position: Position) -> Content:
        """Gives what is in the pot or on the counter at (x, y), one that is looked at."""
        return dict(self.contents)[position]


class Behaviour(ABC):
    """A scripted partner. Subclasses are frozen dataclasses, equal where they do the same."""

    @property
    def sight(self) -> Sight:
        """What it looks at."""
        return Sight()

    def phase(self, t: int) -> int:
        """Gives the earliest time from which on it does the same as from t on; 0 always where the time is no matter."""
        return 0

    @abstractmethod
    def decide(self, scene: Scene) -> int:
        """Chooses an action for what is seen."""

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
        """Refuses a layout that it cannot play.

        Raises:
            UnknownLayout: Cells that it walks to are no floor there, or counters are none.
        """
        for cells, tile, what in ((self.sight.counters, "X", "counter"), (self.floor, " ", "floor")):
            wrong = sorted(set(cells) - set(layout.positions(tile)))
            if wrong:
                raise UnknownLayout(f"{wrong[0]} is no {what} of {layout.name!r}")

    @property
    def floor(self) -> frozenset[Position]:
        """Floor cells that it names."""
        return frozenset()

    def mirrored(self, width: int) -> "Behaviour":
        """Gives what does the same in the mirror image of its kitchen, which is `width` cells wide."""
        return Mirrored(self, width)


@dataclass(frozen=True)
class Mirrored(Behaviour):
    """Does in the mirrored kitchen what another does in the plain one: also where it chooses between equals."""

    plain: Behaviour
    width: int

    @property
    def sight(self) -> Sight:
        """The mirrored sight."""
        plain = self.plain.sight
        return replace(plain, counters=frozenset((self.width - 1 - x, y) for x, y in plain.counters))

    @property
    def floor(self) -> frozenset[Position]:
        """The mirrored cells."""
        return frozenset((self.width - 1 - x, y) for x, y in self.plain.floor)

    def phase(self, t: int) -> int:
        """The plain one's."""
        return self.plain.phase(t)

    def decide(self, scene: Scene) -> int:
        """Asks the plain one about the mirrored scene."""
        other = Chef(scene.mate or (0, 0), scene.mate_facing or "north")
        seen = KitchenState((Chef(scene.position, scene.facing), other))
        me, mate = mirror_state(seen, self.width).chefs
        turned = replace(
            scene,
            layout=_mirrored(scene.layout),
            position=me.position,
            facing=me.facing,
            mate=scene.mate and mate.position,
            mate_facing=scene.mate_facing and mate.facing,
            contents=tuple(
                sorted((((self.width - 1 - x, y), what) for (x, y), what in scene.contents), key=lambda e: e[0][::-1])
            ),
        )
        return int(mirror_actions(_decision(self.plain, turned)))

    def mirrored(self, width: int) -> Behaviour:
        """The plain one."""
        return self.plain


def look(sight: Sight, layout: Layout, state: KitchenState, seat: int, time: int) -> Scene:
    """Gives what a behaviour on a seat sees."""
    me, mate = state.chefs[seat], state.chefs[1 - seat]
    seen = sorted({*(layout.positions("P") if sight.pots else ()), *sight.counters}, key=lambda cell: cell[::-1])
    return Scene(
        layout,
        me.position,
        me.facing,
        "soup" if isinstance(me.holding, Soup) else me.holding,
        mate.position if sight.mate else None,
        mate.facing if sight.mate_facing else None,
        tuple((cell, _content(layout, state, cell)) for cell in seen),
        time,
    )


class ScriptAgent:
    """Puts a behaviour on a seat; all rows start their clocks with `reset`.

    Args:
        behaviour: What it does.
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
            UnknownLayout: The behaviour is about cells that the layout has not.
        """
        if self._layout is None or layout != self._layout.name:
            self._layout = Layout.load(layout)
        self._behaviour.check(self._layout)
        self._seats, self._step = [int(seat) for seat in seats], 0

    def act(self, observations: Sequence[KitchenState]) -> NDArray[np.int64]:
        """Chooses one action a row."""
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
