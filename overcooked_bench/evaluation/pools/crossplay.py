"""Cross-play: every agent of a pool with every other one and with itself, from both seats.

Axes: P agents, E episodes of each cell.
"""

import csv
from collections.abc import Callable, Sequence
from fnmatch import fnmatchcase
from pathlib import Path
from typing import Final, NamedTuple

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.pools.manifest import PoolError
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.games.engines import map_tasks
from overcooked_bench.evaluation.games.play import make_kitchens, play
from overcooked_bench.evaluation.games.roster import Partner, pool_as_hashed, seat_partners
from overcooked_bench.evaluation.games.streams import stream_key
from overcooked_bench.evaluation.pools.matrix import agreement
from overcooked_bench.evaluation.scores import Source

SCHEMA: Final = 1
EPISODES: Final = 20


class Player(msgspec.Struct, frozen=True, kw_only=True):
    """An agent of the matrix.

    Attributes:
        name: Unique on its layout.
        method: How it was trained.
        lineage: Equal for agents that are tied to each other.
        checkpoint: Share of its run's training that it has had.
        sha256: Of its weights.
    """

    name: str
    method: str
    lineage: str
    checkpoint: float
    sha256: str


class CrossPlay(msgspec.Struct, frozen=True, kw_only=True):
    """The content of a cross-play file.

    Attributes:
        schema: Version of this file format.
        pool: The pool of the agents.
        layout: The layout that was played.
        episodes: E, the number of episodes per cell.
        seed: Seed of the start states and random streams.
        agents: The P agents, in the order of rows and columns.
        means: (P, P) points per episode; row: the agent on seat 0, column: the one on seat 1.
        errors: (P, P) their standard errors over episodes.
        self_play: Mean of the diagonal.
        cross_play: Mean over pairs of different lineages.
        ratio: `cross_play` divided by `self_play`; None if self-play scores nothing.
        units: Number of independent agents, which is the number of lineages.
    """

    schema: int
    pool: Source
    layout: str
    episodes: int
    seed: int
    agents: tuple[Player, ...]
    means: tuple[tuple[float, ...], ...]
    errors: tuple[tuple[float, ...], ...]
    self_play: Estimate
    cross_play: Estimate
    ratio: Estimate | None
    units: int

    @property
    def worst(self) -> tuple[str, str, float]:
        """The pair of strangers that reaches least: on seat 0, on seat 1, mean points."""
        pairs = [
            (mean, mine.name, other.name)
            for mine, row in zip(self.agents, self.means, strict=True)
            for other, mean in zip(self.agents, row, strict=True)
            if mine.lineage != other.lineage
        ]
        mean, mine, other = min(pairs)
        return mine, other, mean

    def write(self, stem: Path) -> None:
        """Writes `<stem>.json`, everything, and `<stem>.csv`, the means."""
        stem.parent.mkdir(parents=True, exist_ok=True)
        stem.with_suffix(".json").write_bytes(msgspec.json.format(msgspec.json.encode(self), indent=1) + b"\n")
        with stem.with_suffix(".csv").open("w", newline="", encoding="utf-8") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(["seat 0 \\ seat 1", *(agent.name for agent in self.agents)])
            for agent, row in zip(self.agents, self.means, strict=True):
                writer.writerow([agent.name, *row])


class _Row(NamedTuple):
    """One row of the matrix, the unit of play.

    Attributes:
        pool: Folder.
        pool_sha256: The pool's hash when playing began.
        layout: Where.
        agents: All agents' names.
        first: Index of the one on seat 0.
        episodes: With each of them.
        seed: Of all streams.
        horizon: Steps of an episode.
    """

    pool: str
    pool_sha256: str
    layout: str
    agents: tuple[str, ...]
    first: int
    episodes: int
    seed: int
    horizon: int


def choose(pool: Pool, layout: str, patterns: Sequence[str] = (), checkpoints: bool = False) -> tuple[Entry, ...]:
    """Chooses agents of a layout.

    Args:
        pool: The pool of the agents.
        layout: The layout to play.
        patterns: Names of agents, with the wildcards `*` and `?`; all agents by default.
        checkpoints: Whether to take all of a lineage, instead of only the most trained one.

    Raises:
        PoolError: The pool has no agents there, a pattern fits none, or they are not of two lineages at least.
    """
    agents = pool.agents(layout)
    if not agents:
        raise PoolError(f"pool {pool.name!r} has no agents for {layout!r}; it has {', '.join(pool.layouts)}")
    for pattern in patterns:
        if not any(fnmatchcase(agent.name, pattern) for agent in agents):
            names = ", ".join(agent.name for agent in agents)
            raise PoolError(f"pool {pool.name!r}, {layout}: no agent is named {pattern!r}; there are {names}")
    chosen = [a for a in agents if not patterns or any(fnmatchcase(a.name, pattern) for pattern in patterns)]
    if not checkpoints:
        most: dict[str, Entry] = {}
        for agent in chosen:
            known = most.setdefault(agent.lineage, agent)
            if agent.trained.done > known.trained.done:
                most[agent.lineage] = agent
        chosen = sorted(most.values(), key=lambda agent: agent.name)
    if len({agent.lineage for agent in chosen}) < 2:
        raise PoolError(f"pool {pool.name!r}, {layout}: cross-play needs agents of two lineages at least")
    return tuple(chosen)


def cross_play(
    pool: Pool,
    layout: str,
    agents: Sequence[Entry] | None = None,
    episodes: int = EPISODES,
    seed: int = 0,
    horizon: int = 400,
    workers: int = 1,
    engine: str = "local",
    on_progress: Callable[[int, int], object] = lambda done, of: None,
) -> CrossPlay:
    """Plays every pair of agents, as the pool says: its cooking mode and its action mode, from random starts.

    A pair meets the same start states with its seats exchanged.

    Args:
        pool: The pool of the agents.
        layout: The layout to play.
        agents: The agents to pair; by default what `choose` returns.
        episodes: E, at least two.
        seed: Seed of the start states and random streams.
        horizon: Steps of an episode.
        workers: Processes.
        engine: "local", "dask" or "ray".
        on_progress: Called with rows done and all rows.

    Raises:
        PoolError: The pool was changed while it was played.
        ValueError: Fewer than two episodes, or agents of one lineage alone.
    """
    if episodes < 2:
        raise ValueError(f"episodes={episodes}; give two at least, one has no standard error")
    chosen = tuple(choose(pool, layout) if agents is None else agents)
    names, folder = tuple(agent.name for agent in chosen), str(pool.folder.absolute())
    rows = [_Row(folder, pool.hash, layout, names, i, episodes, seed, horizon) for i in range(len(names))]
    returns = np.empty((len(names), len(names), episodes))
    for done, (first, row) in enumerate(map_tasks(_play_row, rows, min(workers, len(rows)), engine), start=1):
        returns[first] = row
        on_progress(done, len(rows))
    means, errors = returns.mean(axis=2), returns.std(axis=2, ddof=1) / episodes**0.5
    found = agreement(means, [agent.lineage for agent in chosen])
    return CrossPlay(
        schema=SCHEMA,
        pool=Source(pool.name, pool.hash),
        layout=layout,
        episodes=episodes,
        seed=seed,
        agents=tuple(
            Player(
                name=agent.name,
                method=agent.trained.method,
                lineage=agent.lineage,
                checkpoint=agent.trained.done,
                sha256=agent.sha256,
            )
            for agent in chosen
        ),
        means=_told(means),
        errors=_told(errors),
        self_play=found.self_play,
        cross_play=found.cross_play,
        ratio=found.ratio,
        units=found.units,
    )


def _play_row(row: _Row) -> tuple[int, NDArray[np.float64]]:
    """Plays one agent on seat 0 with all on seat 1: its index and (P, E) returns."""
    pool = pool_as_hashed(row.pool, row.pool_sha256)
    found = [pool.agent(row.layout, name) for name in row.agents]
    partners = [Partner(agent) for agent in found]
    size, mine = len(partners), partners[row.first].sha256
    others = np.repeat(np.arange(size), row.episodes)
    firsts, seat = np.full(len(others), row.first), np.zeros(len(others), np.int64)
    starts, streams = [], []
    for partner in partners:
        for episode in range(row.episodes):
            low, high = sorted((mine, partner.sha256))
            pair = ("crossplay", row.seed, row.layout, episode, low, high)
            starts.append(stream_key(*pair, "start"))
            streams.append([stream_key(*pair, mine, k) for k in range(2)])
    with one_thread():
        parties = [
            *seat_partners(partners, firsts, seat, pool, pool.mode, row.layout),
            *seat_partners(partners, others, seat + 1, pool, pool.mode, row.layout),
        ]
        kitchens = make_kitchens(row.layout, len(others), parties, cooking=pool.cooking, horizon=row.horizon)
        kitchens.reset(seed=np.array(starts, np.uint64))
        games = play(kitchens, parties, np.array(streams, np.uint64))
    return row.first, games.soup_reward.sum(axis=1).reshape(size, row.episodes)


def _told(matrix: NDArray[np.float64]) -> tuple[tuple[float, ...], ...]:
    return tuple(tuple(round(value, 3) for value in row) for row in matrix.tolist())
