"""The two seats of an environment: the ego agent's, and the partner's.

Axes: N kitchens.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np

from overcooked_bench.agents.agent import Agent, Reference
from overcooked_bench.agents.seated import Seated
from overcooked_bench.kitchen.codes import STAY
from overcooked_bench.kitchen.layout import Layout

RANDOM_SEAT: Final = "random"
STAY_ACTION: Final = STAY
LARGEST_DRAW: Final = 2**63
"""One draw per episode gives both the ego agent's seat, the lowest bit, and the partner's seed, the others."""


def seat_partner(partner: Reference | Agent, layout: Layout, num_kitchens: int) -> Seated | None:
    """Seats the partner in all kitchens; returns None for "stay", whose action is always `STAY_ACTION`."""
    if isinstance(partner, str) and partner == "stay":
        return None
    return Seated(*find_partner(partner, layout), np.arange(num_kitchens))


def checked_seat(seat: str | int) -> str | int:
    """Checks and returns a seat.

    Raises:
        ValueError: There is no such seat.
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
        The agent, and its name.

    Raises:
        TypeError: It is not an agent.
    """
    if isinstance(partner, str | Path | Mapping):
        from overcooked_bench.agents.catalogue import load_agent

        return load_agent(partner, layout.name), f"partner {str(partner)!r}"
    if not isinstance(partner, Agent):
        raise TypeError(
            f"partner={partner!r}; give a catalogue name, the path of a submission, or an object with "
            "observation, reset(layout, seats, seeds) and act(observations)"
        )
    return partner, f"partner {type(partner).__name__}"
