"""An adapter that hands an agent its rows in reverse order."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import Agent
from overcooked_bench.agents.submissions.checks import check_actions


class Turned:
    """Plays as an agent does whose rows come in reverse order; an agent that keeps the contract plays the same.

    Args:
        agent: The agent.
    """

    def __init__(self, agent: Agent) -> None:
        self.observation = agent.observation
        self._agent = agent

    def reset(self, layout: str, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Starts new episodes."""
        self._agent.reset(layout, seats[::-1].copy(), seeds[::-1].copy())

    def act(self, observations: Any) -> NDArray[np.int64]:
        """Chooses one action per row.

        Raises:
            ActionError: The agent answered with something else.
        """
        turned = observations[::-1]
        answer = self._agent.act(turned.copy() if isinstance(turned, np.ndarray) else turned)
        return check_actions(answer, len(observations))[::-1].copy()
