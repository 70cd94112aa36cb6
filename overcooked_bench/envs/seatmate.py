"""The partner on the other seat: any agent, shown what it asks for, its answers checked.

Axes: N kitchens.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent, Reference
from overcooked_bench.kitchen.codes import STAY
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS

RANDOM_SEAT: Final = "random"
STAY_ACTION: Final = STAY
LARGEST_DRAW: Final = 2**63
"""One draw an episode serves both the ego agent's seat, the lowest bit, and the partner's seed, the others."""

STATE: Final = "state"
"""The observation of agents that are given each kitchen's `KitchenState`."""


class Seatmate:
    """One agent that plays the other seat of N kitchens, asked once a step for all of them.

    Args:
        agent: Who plays.
        name: What it is called in messages.

    Attributes:
        observation: What the agent is shown, a name of `Kitchens.observe` or "state".
    """

    def __init__(self, agent: Agent, name: str) -> None:
        self._agent, self._name = agent, name
        self.observation = agent.observation
        if self.observation not in (*OBSERVATIONS, STATE):
            raise ValueError(
                f"partner {name} has observation={self.observation!r}; "
                f"choose one of {', '.join((*OBSERVATIONS, STATE))}"
            )

    def reset(
        self,
        kitchens: Kitchens,
        seats: NDArray[np.int64],
        seeds: NDArray[np.uint64],
        share: NDArray[np.int64] | None = None,
    ) -> None:
        """Starts new episodes.

        Args:
            kitchens: The kitchens.
            seats: (N,) the partner's own seats.
            seeds: (N,) uint64.
            share: (M,) which of the kitchens this partner serves, all by default.
        """
        self._share = np.arange(kitchens.num_kitchens) if share is None else share
        neighbours = bool((np.diff(self._share) == 1).all())
        self._where = slice(self._share[0], self._share[-1] + 1) if neighbours else self._share
        self._seats = seats
        self._agent.reset(kitchens.layout.name, seats[self._where], seeds[self._where])

    def act(self, kitchens: Kitchens, views: NDArray[Any] | None = None) -> NDArray[Any]:
        """Asks for the next actions.

        Args:
            kitchens: The kitchens.
            views: (N, ...) what `kitchens.observe` gives for this partner's observation and seats, where the caller
                has it already.

        Returns:
            (M,) whole numbers.

        Raises:
            ValueError: The agent answered with something else.
        """
        n = len(self._share)
        shown: Any
        if self.observation == STATE:
            shown = [kitchens.state(int(i)) for i in self._share]
        else:
            if views is None:
                views = kitchens.observe(self.observation, seats=self._seats)
            shown = views[self._where]
        actions = np.asarray(self._agent.act(shown))
        if actions.shape != (n,) or actions.dtype.kind not in "iu":
            raise ValueError(
                f"partner {self._name} answered with the shape {actions.shape} and the type {actions.dtype}; "
                f"act() must give whole numbers of the shape ({n},)"
            )
        return actions

    def shown_by(self, kitchens: Kitchens) -> None:
        """Checks that these kitchens can show what the agent wants to see.

        Raises:
            ValueError: They cannot; says why.
        """
        if self.observation != STATE:
            kitchens.observation_shape(self.observation)


def seatmate(partner: Reference | Agent, layout: Layout) -> Seatmate | None:
    """Gives the partner, or None for "stay", which needs no asking: its action is always `STAY_ACTION`."""
    return None if isinstance(partner, str) and partner == "stay" else Seatmate(*find_partner(partner, layout))


def checked_seat(seat: str | int) -> str | int:
    """Gives the seat back.

    Raises:
        ValueError: It is none.
    """
    if seat not in (RANDOM_SEAT, 0, 1):
        raise ValueError(f"seat={seat!r}; give 0, 1, or {RANDOM_SEAT!r} for a seat drawn for each episode")
    return seat


def needed_layout(layout: str | Path | Layout | None) -> Layout:
    """Reads the layout.

    Raises:
        ValueError: None was given.
        LayoutError: It is not legal.
    """
    if layout is None:
        raise ValueError(
            "no layout was given; write layout= with a grid's text, the path of a .layout file or a shipped name"
        )
    return Layout.load(layout)


def find_partner(partner: Reference | Agent, layout: Layout) -> tuple[Agent, str]:
    """Finds a partner: what `find` takes, or an Agent.

    Returns:
        The agent, and what to call it.

    Raises:
        TypeError: It is no agent.
    """
    if isinstance(partner, str | Path | Mapping):
        from overcooked_bench.agents.catalogue import load_agent

        return load_agent(partner, layout.name), repr(str(partner))
    if not isinstance(partner, Agent):
        raise TypeError(
            f"partner={partner!r}; give a catalogue name, the path of a submission, or an object with "
            "observation, reset(layout, seats, seeds) and act(observations)"
        )
    return partner, type(partner).__name__
