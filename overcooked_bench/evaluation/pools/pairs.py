"""Plays pairs of players of any pools, in big batches.

Axes: N pairs, E episodes of each pair from each seat, K = 2 seats of the pair's agent.
"""

from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.pools.records import Entry, PolicyReference
from overcooked_bench.agents.seated import Seated
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.evaluation.games.episode import side_of
from overcooked_bench.evaluation.games.play import Games, make_kitchens, play
from overcooked_bench.evaluation.games.roster import pool_as_hashed, seat_policies, seat_scripted
from overcooked_bench.evaluation.games.streams import stream_key
from overcooked_bench.evaluation.pools.players import Player, common_cooking
from overcooked_bench.kitchen.kitchens import Kitchens, StepResult
from overcooked_bench.kitchen.layout import Layout

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.policy import Policy

MOST_ROWS: Final = 4096
"""Kitchens of one batch; greater ones are hardly faster, and need more memory."""


class Cast(NamedTuple):
    """The way a player travels to a worker process.

    Attributes:
        folder: Its pool's folder; "" without a pool.
        pool_sha256: Its pool's hash when playing began.
        mode: How its pool's policies act.
        entry: What the pool says about it.
    """

    folder: str
    pool_sha256: str
    mode: str
    entry: Entry


class Block(NamedTuple):
    """Pairs that are played in one batch: (pair, episode, seat) in row-major order are its rows.

    Attributes:
        first: Index of the first pair among all, in the order in which they are played.
        layout: Where.
        cooking: The cooking mode.
        cast: The players.
        pairs: For each pair the indices in the cast of its agent and of its partner.
        episodes: E.
        purpose: What the episodes are for, which all streams depend on.
        seed: Of all streams.
        horizon: Steps of an episode.
        start: "random" or "standard".
        object_probability: Chance of each pot and each pair of hands to be filled at the start.
    """

    first: int
    layout: str
    cooking: str
    cast: tuple[Cast, ...]
    pairs: tuple[tuple[int, int], ...]
    episodes: int
    purpose: str
    seed: int
    horizon: int
    start: str = "random"
    object_probability: float = 0.0

    @property
    def rows(self) -> int:
        """Kitchens."""
        return len(self.pairs) * self.episodes * 2

    @property
    def seats(self) -> NDArray[np.int64]:
        """(rows,) the seat of each row's agent."""
        return np.tile(np.arange(2), self.rows // 2)


class Played(NamedTuple):
    """The result of a block.

    Attributes:
        returns: (N, E, K) points of the team.
        sides: (N, E, K) int64, region of the floor that the pair's agent starts in.
    """

    returns: NDArray[np.float64]
    sides: NDArray[np.int64]


def cut(
    layout: str,
    players: Sequence[Player],
    pairs: Sequence[tuple[int, int]],
    episodes: int,
    purpose: str,
    seed: int,
    horizon: int,
) -> Iterator[Block]:
    """Cuts pairs into blocks, whatever the number of workers.

    Args:
        layout: Where.
        players: Everybody.
        pairs: For each pair the indices of its agent and of its partner; pairs of one partner are neighbours, so that a
            block has few partners and each network computes many rows.
        episodes: E.
        purpose: What the episodes are for.
        seed: Of all streams.
        horizon: Steps of an episode.

    Raises:
        WrongUse, PoolError: Of `common_cooking`.
    """
    cooking = common_cooking(layout, players)
    cast = [
        Cast("", "", "sample", player.entry)
        if player.pool is None
        else Cast(str(player.pool.folder.absolute()), player.pool.hash, player.pool.mode, player.entry)
        for player in players
    ]
    ends = _ends([partner for _, partner in pairs], max(1, MOST_ROWS // (2 * episodes)))
    for first, end in zip([0, *ends], ends, strict=False):
        used, index = np.unique(np.array(pairs[first:end]), return_inverse=True)
        chosen = tuple(cast[i] for i in used.tolist())
        renamed = tuple((a, p) for a, p in index.reshape(-1, 2).tolist())
        yield Block(first, layout, cooking, chosen, renamed, episodes, purpose, seed, horizon)


def _ends(partners: Sequence[int], most: int) -> list[int]:
    """Returns where blocks end that have so many pairs at most, and all pairs of a partner where that is possible."""
    size = len(partners)
    changes = [i for i in range(1, size) if partners[i] != partners[i - 1]] + [size]
    ends: list[int] = []
    while (first := ends[-1] if ends else 0) < size:
        whole = [end for end in changes if first < end <= first + most]
        ends.append(whole[-1] if whole else first + most)
    return ends


def play_block(block: Block) -> tuple[int, Played]:
    """Plays a block.

    Returns:
        The block's `first`, and what came out.

    Raises:
        PoolError: A pool was changed while it was played.
    """
    shape, layout = (len(block.pairs), block.episodes, 2), Layout.load(block.layout)
    games = play_games(block)
    sides = [side_of(layout, start, seat) for start, seat in zip(games.starts, block.seats.tolist(), strict=True)]
    return block.first, Played(games.soup_reward.sum(axis=1).reshape(shape), np.reshape(sides, shape))


def play_games(block: Block, watch: Callable[[Kitchens, StepResult], object] | None = None) -> Games:
    """Plays the games of a block.

    Every agent meets a partner from the same start states, in each of them from both seats.

    Args:
        block: What to play.
        watch: As for `play`; the rows are those of the block.

    Raises:
        PoolError: A pool was changed while it was played.
    """
    shape = len(block.pairs), block.episodes, 2
    hashes = [one.entry.sha256 for one in block.cast]
    starts, streams = np.empty(shape, np.uint64), np.empty((*shape, 2), np.uint64)
    for n, (agent, partner) in enumerate(block.pairs):
        for episode in range(block.episodes):
            starts[n, episode] = stream_key(block.purpose, block.seed, block.layout, hashes[partner], episode, "start")
            for seat in range(2):
                key = block.purpose, block.seed, block.layout, hashes[agent], hashes[partner], seat, episode
                streams[n, episode, seat, seat] = stream_key(*key, "agent")
                streams[n, episode, seat, 1 - seat] = stream_key(*key, "partner")
    with one_thread():
        who = np.repeat(np.array(block.pairs), shape[1] * 2, axis=0).T
        parties = _seated(block, who, np.stack([block.seats, 1 - block.seats]))
        starts_of = {"start": block.start, "object_probability": block.object_probability}
        kitchens = make_kitchens(
            block.layout, block.rows, parties, cooking=block.cooking, horizon=block.horizon, **starts_of
        )
        kitchens.reset(seed=starts.ravel())
        return play(kitchens, parties, streams.reshape(-1, 2), watch)


def _seated(block: Block, who: NDArray[np.int64], seats: NDArray[np.int64]) -> list[Seated]:
    """Makes the agents of a block.

    Args:
        block: The block.
        who: (2, rows) index in the cast of the agent and of the partner in each kitchen.
        seats: (2, rows) their seats.
    """
    parties: list[Seated] = []
    stacks: dict[str, dict[int, Policy]] = {}
    scripted: dict[str, list[int]] = {}
    for index, one in enumerate(block.cast):
        if isinstance(one.entry.reference, PolicyReference):
            pool = pool_as_hashed(one.folder, one.pool_sha256)
            stacks.setdefault(one.mode, {})[index] = pool.policy(block.layout, one.entry.name)
        else:
            scripted.setdefault(one.entry.sha256, []).append(index)
    for indices in scripted.values():
        places, rows = np.nonzero(np.isin(who, indices))
        parties.append(seat_scripted(block.cast[indices[0]].entry, rows, seats[places, rows], block.layout))
    for mode, policies in stacks.items():
        for side in range(2):
            parties += seat_policies(policies, who[side], seats[side], mode, block.layout)
    return parties


def points_from(returns: NDArray[np.float64], sides: NDArray[np.int64], side: int) -> NDArray[np.float64]:
    """Returns what a pair's agent reached from a side, one mean per start state that it played from there.

    A start state is played from both seats; on a floor of one region both are the same side, and are no independent
    episodes.

    Args:
        returns: (E, K) points.
        sides: (E, K) side on which the agent started.
        side: Which one is meant.
    """
    there = sides == side
    number = there.sum(axis=1)
    found: NDArray[np.float64] = (returns * there).sum(axis=1)[number > 0] / number[number > 0]
    return found
