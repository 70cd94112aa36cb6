"""Several partners, each of which plays its own share of the kitchens of one batch.

Axes: N kitchens.
"""

from collections.abc import Hashable, Mapping, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent, Reference
from overcooked_bench.agents.policies.ensemble import JoinedAgents
from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.seated import Seated, Views
from overcooked_bench.envs.seats import find_partner
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout


class Partners:
    """A list of partners spread evenly over N kitchens, in groups of adjacent kitchens.

    Neural agents of one observation and mode act together, in one stacked forward pass for each architecture; every row
    plays as its own agent would, up to rounding. Each observation is made once for all partners that use it.

    Args:
        partners: References as `find` takes them, or agents.
        layout: The layout they play.
        num_kitchens: N, at least as many as partners.

    Attributes:
        given: The list as it was given.
        observations: The partners' observations.

    Raises:
        ValueError: No partner, or more partners than kitchens.
    """

    def __init__(self, partners: Sequence[Reference | Agent], layout: Layout, num_kitchens: int) -> None:
        if isinstance(partners, str | Path | Mapping) or not partners:
            raise ValueError(f"partners={partners!r}; give a list with at least one partner, such as ['greedy']")
        if len(partners) > num_kitchens:
            raise ValueError(f"{len(partners)} partners for {num_kitchens} kitchens; each needs at least one kitchen")
        objects = [partner for partner in partners if not isinstance(partner, str | Path | Mapping)]
        if len({id(partner) for partner in objects}) != len(objects):
            raise ValueError("one agent object is in the list twice; give each group of kitchens its own")
        self.given = tuple(partners)
        shares = np.array_split(np.arange(num_kitchens), len(partners))
        together: dict[Hashable, list[int]] = {}  # of neural agents, those that can act together
        agents, names = zip(*(find_partner(partner, layout) for partner in partners), strict=True)
        for i, agent in enumerate(agents):
            joinable = type(agent) is NeuralAgent
            kind = (agent.observation, agent.layout, agent.mode) if joinable else i
            together.setdefault(kind, []).append(i)
        self._seated: list[Seated] = []
        for group in together.values():
            parts = [shares[i] for i in group]
            agent, name = agents[group[0]], names[group[0]]
            if len(group) > 1:
                agent, name = JoinedAgents([agents[i] for i in group], list(map(len, parts))), "the partners' policies"
            self._seated.append(Seated(agent, name, np.concatenate(parts)))
        self.observations = tuple(partner.observation for partner in self._seated)

    def fit(self, kitchens: Kitchens) -> None:
        """Checks that these kitchens have the observations that the partners need.

        Raises:
            SeatedFault: They cannot; says why.
        """
        for partner in self._seated:
            partner.fit(kitchens)

    def reset(self, kitchens: Kitchens, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts new episodes in all kitchens; `seats` (N,) are the partners' seats, `seeds` (N,) uint64."""
        self._seats = seats
        for partner in self._seated:
            partner.reset(kitchens.layout.name, seeds[partner.where], seats[partner.where])

    def act(self, kitchens: Kitchens) -> NDArray[np.int64]:
        """Asks every partner for its actions: (N,) int64."""
        views, actions = Views(kitchens, self._seats), np.empty(kitchens.num_kitchens, np.int64)
        for partner in self._seated:
            actions[partner.where] = partner.act(views.of(partner))
        return actions
