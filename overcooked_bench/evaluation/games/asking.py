"""Asks an agent whether it plays a layout, before anything is played there."""

from typing import NamedTuple

import numpy as np

from overcooked_bench.agents.agent import AgentFactory, UnknownLayout
from overcooked_bench.agents.catalogue import find_unchanged
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.saying import say
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.agents.watch import LOADING, calling
from overcooked_bench.evaluation.games.block import Block
from overcooked_bench.kitchen.layout import MIRRORED


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
            make = find_unchanged(block.agent, block.agent_sha256, block.protocol.play.mode).make
        try:
            _start(make, layout, run, adapted=False)
        except UnknownLayout as reason:
            if not layout.endswith(MIRRORED):
                return Answer(layout, declined=say(reason) or "it gives no reason")
        else:
            return Answer(layout)
        try:
            _start(make, layout, run, adapted=True)
        except UnknownLayout as reason:
            return Answer(layout, declined=say(reason) or "it gives no reason")
    return Answer(layout, adapted=True)


def _start(make: AgentFactory, layout: str, training_seed: int, adapted: bool) -> None:
    try:
        with calling("make_agent", LOADING):
            ego = make(layout.removesuffix(MIRRORED) if adapted else layout, training_seed)
        with calling("reset", LOADING):
            agent = mirrored(ego) if adapted else ego
            agent.reset(layout, np.zeros(1, np.int64), np.zeros(1, np.uint64))
    except UnknownLayout:
        raise
    except BaseException as error:
        if isinstance(error, KeyboardInterrupt):
            raise
