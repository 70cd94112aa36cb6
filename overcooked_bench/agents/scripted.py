"""The scripted agents: `stay`, `random`, two couriers that do half the work each, and `greedy`, which does it all.

Axes: B rows (simultaneous episodes), H x W the grid.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent, sample_actions, uniforms
from overcooked_bench.agents.planner.tables import make_tables
from overcooked_bench.kitchen.codes import NUM_ACTIONS, STAY
from overcooked_bench.kitchen.layout import Layout

SCRIPTED: Final = ("stay", "random", "onion_courier", "dish_courier", "greedy")
"""Names of the scripted agents."""

BEHAVIOUR: Final = 1
"""Version of what they do; it goes up when one acts differently, since scores against it compare no more then."""

_PLANNERS: Final = ("greedy", "onion_courier", "dish_courier")  # in the order of the roles of errands.py
_SEAT_SALT: Final = 0x5851F42D4C957F2D  # keeps two copies with the same seeds apart


def make_scripted(name: str, layout: str | Layout) -> Agent:
    """Makes a scripted agent.

    Args:
        name: One of `SCRIPTED`.
        layout: What it will play: a shipped name, a grid's text, a file or a Layout, whose orders are cooked where
            `reset` names the same layout.

    Raises:
        ValueError: No such agent, or no such layout.
    """
    if name not in SCRIPTED:
        raise ValueError(f"no scripted agent named {name!r}; there are {', '.join(SCRIPTED)}")
    if name == "stay":
        return Stay()
    if name == "random":
        return Random()
    return Planner(name, Layout.load(layout))


class _Simple:
    """What needs no plan."""

    observation = "lossless26"

    def __init__(self) -> None:
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
        """Draws one action a row."""
        self._step += 1
        uniform = np.full((len(self._seeds), NUM_ACTIONS), 1 / NUM_ACTIONS)
        return sample_actions(uniform, self._seeds, self._step - 1)


class Planner:
    """Goes shortest paths to what is most useful now, given what both chefs hold and what lies where.

    Args:
        name: "greedy" does every job; "onion_courier" brings ingredients to pots and never plates; "dish_courier" waits
            for soups, plates and serves them and never brings ingredients. All start full pots where that is needed.
        layout: Whose orders are cooked.
    """

    observation = "lossless26"

    def __init__(self, name: str, layout: Layout) -> None:
        self._role = _PLANNERS.index(name)
        self._layout, self._plan = layout, make_tables(layout)
        self._seeds: NDArray[np.uint64] = np.zeros(0, np.uint64)
        self._step = 0

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts new episodes.

        Raises:
            LayoutError: No such layout.
        """
        from overcooked_bench.agents.planner.facts import FACTS

        if layout != self._layout.name:
            self._layout = Layout.load(layout)
            self._plan = make_tables(self._layout)
        self._seeds = np.asarray(seeds, np.uint64) + np.asarray(seats, np.uint64) * np.uint64(_SEAT_SALT)
        self._step = 0
        self._facts = np.zeros((len(self._seeds), FACTS), np.int64)

    def act(self, observations: NDArray[np.uint8]) -> NDArray[np.int64]:
        """Chooses one action a row.

        Args:
            observations: (B, 26, H, W) uint8.

        Raises:
            ValueError: Another shape than the rows and the layout of `reset` have.
        """
        from overcooked_bench.agents.planner.errands import choose
        from overcooked_bench.agents.planner.facts import look, trust
        from overcooked_bench.agents.planner.steering import walk
        from overcooked_bench.agents.planner.weighing import weigh

        layout, facts = self._layout, self._facts
        wanted = (len(self._seeds), 26, layout.height, layout.width)
        if observations.shape != wanted:
            raise ValueError(f"observations have the shape {observations.shape}; reset() announced {wanted}")
        views = np.ascontiguousarray(observations, np.uint8).reshape(*wanted[:2], -1)
        look(views, facts)
        weigh(views, self._plan, facts)
        trust(facts)
        choose(facts, self._role)
        actions = walk(self._plan, uniforms(self._seeds, self._step), facts)
        self._step += 1
        return actions
