"""Checks that agents that others wrote keep the contract, and names each fault exactly."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.saying import describe, value
from overcooked_bench.errors import AgentFault, WrongUse
from overcooked_bench.kitchen.codes import NUM_ACTIONS


class AgentError(WrongUse):
    """An agent could not be loaded or broke the contract; the message says where and what to write instead."""


class ActionError(AgentError):
    """`act` did not return one action per row.

    Attributes:
        row: The first row whose number is not an action; None if something else is wrong.
    """

    def __init__(self, message: str, row: int | None = None) -> None:
        super().__init__(message)
        self.row = row


class ForeignFault(AgentFault):
    """An agent that plays in a process of its own raised an error, or its process did what it may not.

    Attributes:
        raised: Whether one of the agent's methods raised what the message describes.
    """

    def __init__(self, message: str, raised: bool = False) -> None:
        super().__init__(message)
        self.raised = raised


def check_agent(agent: Any, where: str) -> str:
    """Checks that an object keeps the contract of agents, as far as can be seen without playing.

    Args:
        agent: Any object.
        where: Start of the message, such as the submission's file.

    Returns:
        Its observation.

    Raises:
        AgentError: Something is missing.
    """
    missing = [name for name in ("reset", "act") if not callable(_attribute(agent, name))]
    if missing or isinstance(agent, type):
        lacks = "is a class, not an object" if isinstance(agent, type) else f"has no method {' and no '.join(missing)}"
        raise AgentError(
            f"{where}: {value(agent)} {lacks}; an agent is an object with `observation`, reset(layout, seats, seeds) "
            "and act(observations)"
        )
    try:
        return checked_observation(agent)
    except AgentError as error:
        raise AgentError(f"{where}: {error}") from None


def checked_observation(agent: Any) -> str:
    """Reads the name of an agent's observation.

    Raises:
        AgentError: There is no such observation.
    """
    from overcooked_bench.kitchen.observations.registry import OBSERVATIONS

    observation, known = _attribute(agent, "observation"), (*OBSERVATIONS, "state")
    name = str.__str__(observation) if isinstance(observation, str) else None
    if name not in known:
        raise AgentError(f"the agent's observation is {value(observation)}; choose one of {', '.join(known)}")
    return name


def check_actions(actions: Any, batch: int) -> NDArray[np.int64]:
    """Checks the return value of an agent's `act`.

    Args:
        actions: Any object.
        batch: B, the number of rows of the observations.

    Returns:
        (B,) int64, from 0 to 5, in memory of its own.

    Raises:
        ActionError: A wrong shape, no whole numbers, or one out of range; names the first such row.
    """
    wanted = f"return {batch} whole numbers from 0 to {NUM_ACTIONS - 1}, one per row"
    if type(actions) is np.ndarray:  # any other type may run its own code when it is examined
        given = actions
    else:
        try:
            given = np.asarray(actions.detach().cpu() if hasattr(actions, "detach") else actions)
        except KeyboardInterrupt:
            raise
        except BaseException as error:
            raise ActionError(f"act returned no array ({describe(error)}); {wanted}") from None
    if given.shape != (batch,) or not batch:
        raise ActionError(f"act returned the shape {given.shape} for {batch} rows; {wanted}")
    if given.dtype.kind not in "iu":
        raise ActionError(f"act returned {given.dtype} (row 0: {value(given[0])}); {wanted}")
    own = given.astype(np.int64)
    if own.view(np.uint64).max() >= NUM_ACTIONS:  # negative numbers are large there: one comparison for both bounds
        row = int(((own < 0) | (own >= NUM_ACTIONS)).argmax())
        raise ActionError(f"act returned the action {given[row]} in row {row}; {wanted}", row)
    return own


def _attribute(agent: Any, name: str) -> Any:
    """Reads an attribute; one that raises counts as missing."""
    try:
        return getattr(agent, name, None)
    except KeyboardInterrupt:
        raise
    except BaseException:
        return None
