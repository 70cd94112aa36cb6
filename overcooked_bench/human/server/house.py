"""What all open pages share: how games are played here, with whom, and what is kept."""

import asyncio
from concurrent.futures import Executor
from dataclasses import dataclass, field
from typing import Final

import numpy as np

from overcooked_bench.human.server.chefs import AgentChef, Chef, Person
from overcooked_bench.human.server.keeping import GamesFile, recorded
from overcooked_bench.human.server.live import LiveGame, kitchen_to_play
from overcooked_bench.human.server.offers import Cast
from overcooked_bench.kitchen.codes import STAY

SOURCE: Final = "overcooked-bench play"


@dataclass(frozen=True)
class Terms:
    """How games are played on a server.

    Attributes:
        layouts: Names of those that can be chosen.
        pace: Seconds per step.
        horizon: Steps of a game.
        countdown: Seconds before the first step.
        cooking: Of all kitchens.
        seat: The chef that the page suggests to a person; None leaves that to the page.
    """

    layouts: tuple[str, ...]
    pace: float = 0.15
    horizon: int = 400
    countdown: float = 3.0
    cooking: str = "auto"
    seat: int | None = None


@dataclass
class House:
    """What all games share.

    Attributes:
        terms: How games are played.
        cast: Whom they can be played with.
        threads: Where agents are asked.
        kept: Where games of people who agree go; None keeps nothing.
    """

    terms: Terms
    cast: Cast
    threads: Executor
    kept: GamesFile | None = None
    writing: asyncio.Lock = field(default_factory=asyncio.Lock)

    async def keep(self, game: LiveGame, labels: list[str], notes: str = "") -> bool:
        """Writes a game, if games are kept here; returns whether it was."""
        if self.kept is None:
            return False
        line = await asyncio.to_thread(recorded, game, labels, self.terms.pace, SOURCE, notes)
        async with self.writing:
            await asyncio.to_thread(self.kept.add, line)
        return True

    def game(self, layout: str, cast: list[str | None]) -> LiveGame:
        """Loads the agents and makes the kitchen; takes seconds where a network is loaded.

        Args:
            layout: Where.
            cast: References of the agents on seats 0 and 1; None for a person.

        Raises:
            OvercookedBenchError: An agent cannot play there.
        """
        kitchens = kitchen_to_play(layout, self.terms.horizon, self.terms.cooking)
        chefs: list[Chef] = [
            Person() if agent is None else AgentChef(self.cast.entrant(agent), kitchens, seat, self.threads)
            for seat, agent in enumerate(cast)
        ]
        for chef in chefs:  # compiles here what would hold up all games between two steps
            if isinstance(chef, AgentChef):
                chef.see(kitchens)
        kitchen_to_play(layout, 1, self.terms.cooking).step(np.full((1, 2), STAY))
        return LiveGame(kitchens, chefs)
