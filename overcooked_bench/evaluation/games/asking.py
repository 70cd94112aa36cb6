"""Asks an agent whether it plays a layout, before anything is played there."""

from dataclasses import replace
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from overcooked_bench.agents.agent import Agent, AgentFactory, Reference, UnknownLayout
from overcooked_bench.agents.catalogue import find, find_unchanged
from overcooked_bench.agents.kinds import Entrant
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.saying import say
from overcooked_bench.agents.seated import Seated, SeatedFault
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.agents.watch import LOADING, NO_ANSWER, calling
from overcooked_bench.evaluation.games.block import EGO, Block
from overcooked_bench.kitchen.layout import MIRRORED

if TYPE_CHECKING:
    from overcooked_bench.agents.isolation.settings import Isolation
    from overcooked_bench.agents.policies.neural import Mode


def identify(agent: "tuple[Reference, Mode, Isolation | None]") -> Entrant:
    """Finds an agent in a process that it may end; the entrant that is returned makes no agents.

    Args:
        agent: What `find` takes: the reference, how frozen policies act, and how a submission is isolated.
    """
    reference, mode, isolation = agent
    with calling("loading", LOADING):
        return replace(find(reference, mode=mode, isolation=isolation), make=_elsewhere)


def _elsewhere(layout: str, training_seed: int) -> Agent:
    raise AssertionError("the agent was loaded in another process")


class Answer(NamedTuple):
    """What an agent says about a layout.

    Attributes:
        layout: Which.
        adapted: Whether it plays the layout's mirror image only.
        declined: Why it does not play there, None if it does.
        fault: What went wrong while it was asked, or None.
    """

    layout: str
    adapted: bool = False
    declined: str | None = None
    fault: str | None = None


def ask_block(block: Block) -> Answer:
    """Makes the agent of a block and starts an episode; any fault but UnknownLayout is left to be found by playing.

    Args:
        block: One of the layout's blocks.

    Raises:
        AgentError: The agent was changed since the score began.
    """
    layout, run = block.layout, block.training_seed
    with one_thread():
        with calling("loading", LOADING):
            make = find_unchanged(block.agent, block.agent_sha256, block.protocol.play.mode, block.isolation).make
        why = ""
        for adapted in (False, True) if layout.endswith(MIRRORED) else (False,):
            try:
                late = _start(make, layout, run, adapted)
            except UnknownLayout as reason:
                why = say(reason) or "it gives no reason"
                continue
            fault = f"{layout}, training seed {run}, before any step: {late}" if late else None
            return Answer(layout, adapted, fault=fault)
    return Answer(layout, declined=why)


def _start(make: AgentFactory, layout: str, training_seed: int, adapted: bool) -> str | None:
    """Starts an episode; returns what is wrong if the agent does not answer, which it would not when it plays."""
    try:
        with calling("make_agent", LOADING):
            ego = make(layout.removesuffix(MIRRORED) if adapted else layout, training_seed)
        Seated(mirrored(ego) if adapted else ego, EGO, np.arange(1)).reset(layout, np.zeros(1, np.uint64))
    except (AgentError, SeatedFault) as error:
        return str(error) if NO_ANSWER in str(error) else None
    return None
