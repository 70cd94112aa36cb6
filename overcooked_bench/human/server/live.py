"""`LiveGame`: a kitchen that is being played in, step by step, and what is recorded of it."""

from collections.abc import Sequence
from typing import Any, Final

import numpy as np

from overcooked_bench.human.server.chefs import AgentChef, Chef, Person
from overcooked_bench.kitchen.codes import SERVED
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.rendering.viewer.games import pack_frame

HISTORY: Final = 3
"""Past states that a kitchen keeps, for agents that are shown them."""


def kitchen_to_play(layout: str, horizon: int, cooking: str) -> Kitchens:
    """Makes one kitchen at its standard start."""
    return Kitchens(
        layout,
        1,
        cooking=cooking,
        horizon=horizon,
        start="standard",
        history=HISTORY,
        autoreset=False,
        actions_taken=True,
    )


class LiveGame:
    """A game in one kitchen.

    Args:
        kitchens: One kitchen at its start.
        chefs: Who moves the chefs on seats 0 and 1.

    Attributes:
        chefs: Who moves them; a seat's can change between two steps.
        points: Of the team so far.
        soups: Delivered so far, paid for or not.
        actions: The joint actions so far.
    """

    def __init__(self, kitchens: Kitchens, chefs: Sequence[Chef]) -> None:
        self.chefs = list(chefs)
        self.points, self.soups = 0.0, 0
        self.actions: list[tuple[int, int]] = []
        self._kitchens = kitchens

    @property
    def layout(self) -> Layout:
        """Where."""
        return self._kitchens.layout

    @property
    def cooking(self) -> str:
        """The kitchen's cooking mode."""
        return self._kitchens.cooking

    @property
    def horizon(self) -> int:
        """Steps of the whole game."""
        return self._kitchens.horizon

    @property
    def left(self) -> int:
        """Steps that are still to be played."""
        return self.horizon - len(self.actions)

    @property
    def late(self) -> int:
        """Steps in which an agent's answer was not there in time."""
        return sum(chef.late for chef in self.chefs if isinstance(chef, AgentChef))

    def frame(self) -> list[Any]:
        """Returns the picture of now, as `kitchen.js` draws it."""
        return pack_frame(self.layout, (self._kitchens.state(0), self.points))

    def look(self) -> None:
        """Shows the state to the chefs, who have until the step to decide."""
        for chef in self.chefs:
            chef.look(self._kitchens)

    def step(self) -> None:
        """Plays one step, with what the chefs have decided.

        Raises:
            AgentFault: An agent broke its contract; the step was not played.
        """
        first, second = (chef.action() for chef in self.chefs)
        result = self._kitchens.step(np.array([[first, second]], np.int64))
        self.actions.append((first, second))
        self.points += float(result.soup_reward.sum())
        assert result.actions_taken is not None
        self.soups += int((result.actions_taken & SERVED != 0).sum())

    def person(self, seat: int) -> Person | None:
        """Returns the person on a seat, None if an agent sits there."""
        chef = self.chefs[seat]
        return chef if isinstance(chef, Person) else None
