"""What is asked of agents that others wrote: that they keep the contract, and that a fault is named exactly."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen.codes import NUM_ACTIONS


class AgentError(WrongUse):
    """An agent could not be loaded or broke the contract; the message says where and what to write instead."""


def check_agent(agent: Any, where: str) -> None:
    """Checks that an object keeps the contract of agents, as far as can be seen without playing.

    Args:
        agent: Any object.
        where: What the message begins with, such as the submission's file.

    Raises:
        AgentError: Something is missing.
    """
    missing = [name for name in ("reset", "act") if not callable(getattr(agent, name, None))]
    if missing or isinstance(agent, type):
        lacks = "is a class, not an object" if isinstance(agent, type) else f"has no method {' and no '.join(missing)}"
        raise AgentError(
            f"{where}: {agent!r} {lacks}; an agent is an object with `observation`, reset(layout, seats, seeds) and "
            "act(observations)"
        )
    from overcooked_bench.kitchen.observations.registry import OBSERVATIONS

    observation, known = getattr(agent, "observation", None), (*OBSERVATIONS, "state")
    if not isinstance(observation, str) or observation not in known:
        raise AgentError(f"{where}: the agent's observation is {observation!r}; choose one of {', '.join(known)}")


def check_actions(actions: Any, batch: int, where: str) -> NDArray[np.int64]:
    """Checks what an agent's `act` returned.

    Args:
        actions: Anything.
        batch: B, the number of rows it was asked for.
        where: What the message begins with, such as layout, partner, seat and step.

    Returns:
        (B,) int64, from 0 to 5.

    Raises:
        AgentError: A wrong shape, no whole numbers, or one out of range; names the first such row.
    """
    wanted = f"return {batch} whole numbers from 0 to {NUM_ACTIONS - 1}, one a row"
    if hasattr(actions, "detach"):
        actions = actions.detach().cpu()
    try:
        given = np.asarray(actions)
    except (ValueError, TypeError) as error:
        raise AgentError(f"{where}: act returned no array ({error}); {wanted}") from None
    if given.shape != (batch,):
        raise AgentError(f"{where}: act returned the shape {given.shape} for {batch} rows; {wanted}")
    if given.dtype.kind not in "iu":
        raise AgentError(f"{where}: act returned {given.dtype} (row 0: {given[0]!r}); {wanted}")
    wrong = (given < 0) | (given >= NUM_ACTIONS)
    if wrong.any():
        row = int(wrong.argmax())
        raise AgentError(f"{where}: act returned the action {given[row]} in row {row}; {wanted}")
    return given.astype(np.int64)
