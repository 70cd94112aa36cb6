"""Plays the pairs of strangers that ordered cross-play is made of, each once from both seats."""

from collections.abc import Callable, Sequence

import numpy as np

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.games.engines import map_tasks
from overcooked_bench.evaluation.ordered.entrants import tied
from overcooked_bench.evaluation.pools.pairs import cut, play_block
from overcooked_bench.evaluation.pools.players import Player, common_cooking
from overcooked_bench.evaluation.protocol import Protocol

Means = dict[tuple[str, str], float]
"""(agent, partner) -> points per episode, over episodes and both seats; both ways round, without omitted pairs."""


def play_strangers(
    layout: str,
    groups: Sequence[Sequence[Player]],
    protocol: Protocol,
    seed: int,
    workers: int,
    engine: str,
    on_progress: Callable[[int, int], object],
) -> Means:
    """Plays all pairs of self-play agents, of entrants with these, and of entrants.

    Args:
        layout: Where.
        groups: The self-play agents, then those of each entrant.
        protocol: What is played.
        seed: Of all streams.
        workers: Processes.
        engine: Where they run.
        on_progress: Called with pairs that are done, and all of them.

    Raises:
        WrongUse: The agents are of another cooking mode than the protocol.
        PoolError: A pool was changed while it was played.
    """
    rules, players = protocol.play, [player for group in groups for player in group]
    if (cooking := common_cooking(layout, players)) != rules.cooking:
        raise WrongUse(f"the agents are of cooking mode {cooking}, the protocol {protocol.name} plays {rules.cooking}")
    pairs = _pairs(players, len(groups[0]))
    returns = np.empty(len(pairs))
    purpose = f"ordered/{rules.sha256}/{rules.salt}"
    blocks = [
        block._replace(
            cast=tuple(one._replace(mode=rules.mode) for one in block.cast),
            start=rules.start,
            object_probability=rules.object_probability,
        )
        for block in cut(layout, players, pairs, rules.episodes, purpose, seed, rules.horizon)
    ]
    done = 0
    for first, played in map_tasks(play_block, blocks, min(workers, len(blocks)), engine):
        returns[first : first + len(played.returns)] = played.returns.mean(axis=(1, 2))
        done += len(played.returns)
        on_progress(done, len(pairs))
    found: Means = {}
    for (a, b), mean in zip(pairs, returns.tolist(), strict=True):
        names = players[a].reference, players[b].reference
        found[names] = found[names[::-1]] = mean
    return found


def _pairs(players: Sequence[Player], own: int) -> list[tuple[int, int]]:
    """Returns the pairs of strangers as (agent, partner), those of one partner as neighbours.

    Start states are the partner's; a pair is turned so that it does not depend on the order of the agents.

    Args:
        players: Everybody, the self-play agents first.
        own: How many of them are self-play agents.
    """
    pairs = []
    for b, other in enumerate(players):
        for a, one in enumerate(players[:b]):
            if tied(one.entry, other.entry):
                continue
            with_reference = a < own <= b
            pairs.append((b, a) if with_reference or one.sha256 > other.sha256 else (a, b))
    return sorted(pairs, key=lambda pair: pair[::-1])
