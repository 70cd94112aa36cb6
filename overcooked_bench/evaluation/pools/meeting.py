"""Meetings: every agent of a list with every partner of another one, from both seats.

Axes: A agents, P partners, E episodes from each seat, K = 2 seats of the agent.
"""

from collections.abc import Callable, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.games.engines import map_tasks
from overcooked_bench.evaluation.pools.pairs import Played, cut, play_block
from overcooked_bench.evaluation.pools.players import Player

PURPOSE: Final = "meeting"


class Meeting(NamedTuple):
    """What agents and partners reach together on one layout.

    Attributes:
        layout: Where.
        agents: A references.
        partners: P references.
        returns: (A, P, E, K) float64, points of the team per episode.
        sides: (A, P, E, K) int64, region of the floor that the agent starts in; the same for all agents.
    """

    layout: str
    agents: tuple[str, ...]
    partners: tuple[str, ...]
    returns: NDArray[np.float64]
    sides: NDArray[np.int64]

    @property
    def means(self) -> NDArray[np.float64]:
        """(A, P) points per episode, over episodes and seats."""
        means: NDArray[np.float64] = self.returns.mean(axis=(2, 3))
        return means


def meet(
    layout: str,
    agents: Sequence[Player],
    partners: Sequence[Player],
    episodes: int,
    seed: int = 0,
    workers: int = 1,
    horizon: int = 400,
    on_progress: Callable[[int, int], object] = lambda done, of: None,
    purpose: str = PURPOSE,
    play: Callable[..., Played] | None = None,
) -> Meeting:
    """Plays every agent with every partner, from random starts, in the cooking mode of their pools.

    A start state depends on the purpose, the seed, the layout, the partner and the episode: every agent meets a partner
    from the same ones, in each of them from both seats. Where the floor has two sides, an agent so starts on each of
    them once per episode. How both act depends on who the other one is, too. Results do not depend on the number of
    workers; those of a pair differ between lists of players at most by what the last bits of a network's sums change.

    Args:
        layout: A shipped layout.
        agents: Of any pools, policies and scripted agents; an agent may be among the partners, too, and then meets a
            copy of itself.
        partners: Likewise.
        episodes: E, per seat.
        seed: Seed of the start states and random streams.
        workers: Processes.
        horizon: Steps of an episode.
        on_progress: Called with pairs that are done and all pairs.
        purpose: What the episodes are for: those of another purpose are independent.
        play: Plays the pairs instead of `play_pairs`, with the same arguments.

    Raises:
        WrongUse: No agent, no partner, no episode, a player of another layout, or pools of different cooking modes.
        PoolError: A scripted player has another version here than its pool means, or a pool was changed meanwhile.
    """
    size = len(agents), len(partners)
    pairs = [(a, size[0] + p) for p in range(size[1]) for a in range(size[0])]
    everybody = [*agents, *partners]
    played = (play or play_pairs)(layout, everybody, pairs, episodes, seed, workers, horizon, on_progress, purpose)
    returns, sides = (array.reshape(*size[::-1], episodes, 2).swapaxes(0, 1) for array in played)
    names = [tuple(player.reference for player in players) for players in (agents, partners)]
    return Meeting(layout, names[0], names[1], np.ascontiguousarray(returns), np.ascontiguousarray(sides))


def play_pairs(
    layout: str,
    players: Sequence[Player],
    pairs: Sequence[tuple[int, int]],
    episodes: int,
    seed: int = 0,
    workers: int = 1,
    horizon: int = 400,
    on_progress: Callable[[int, int], object] = lambda done, of: None,
    purpose: str = PURPOSE,
    engine: str = "local",
) -> Played:
    """Plays some pairs of players as `meet` does: N pairs, each of an agent and a partner, as indices of players.

    It is fastest if the pairs of a partner are neighbours. `engine` is "local", "dask" or "ray".

    Raises:
        WrongUse, PoolError: As `meet`.
        EngineError: The engine cannot be used.
    """
    if not pairs or episodes < 1:
        raise WrongUse(f"{len(pairs)} pairs of players and {episodes} episodes; give one of each at least")
    blocks = list(cut(layout, players, pairs, episodes, purpose, seed, horizon))
    returns, sides = np.empty((len(pairs), episodes, 2)), np.empty((len(pairs), episodes, 2), np.int64)
    done = 0
    for first, played in map_tasks(play_block, blocks, min(workers, len(blocks)), engine):
        here = slice(first, first + len(played.returns))
        returns[here], sides[here] = played
        done += len(played.returns)
        on_progress(done, len(pairs))
    return Played(returns, sides)
