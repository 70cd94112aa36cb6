"""Plays the study of agents trained with people, `results/humans-plan.md`, and prints its tables.

    python -m overcooked_bench.baselines.with_people pools/human-study --workers 2

Every entrant plays with every partner of the pool of the protocols `people` and `people-standard`.

Axes: S training runs, P partners, E episode indices, K seats of the entrant.
"""

import argparse
import sys
from collections import defaultdict
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.catalogue import load_agent
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.seated import Seated
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.games.engines import map_tasks
from overcooked_bench.evaluation.games.play import make_kitchens, play
from overcooked_bench.evaluation.games.roster import (
    FLOOR,
    Partner,
    check_pool,
    pool_as_hashed,
    roster,
    seat_partners,
)
from overcooked_bench.evaluation.games.streams import Streams
from overcooked_bench.evaluation.protocol import Protocol, load_protocol

from .with_people_tables import GREEDY, POPULATION, SELF_PLAY, WITH_PEOPLE, Games, report

PROTOCOLS: Final = ("people", "people-standard")
SELF_PLAY_POOL: Final = "train-v1"


class _Task(NamedTuple):
    """An entrant on a layout under a protocol.

    Attributes:
        protocol: What is played.
        pool: Folder of the partners' pool.
        pool_sha256: The pool's hash when playing began.
        layout: Where.
        entrant: Which of the entrants it belongs to.
        agent: Name of the agent, as `find` takes it.
    """

    protocol: Protocol
    pool: str
    pool_sha256: str
    layout: str
    entrant: str
    agent: str


def agents_of(study: Pool, layout: str) -> Iterator[tuple[str, str]]:
    """Lists the agents of a layout, as pairs of the entrant and the agent's name.

    Args:
        study: What `pool build human-study` made.
        layout: Where they play.

    Raises:
        WrongUse: The pool has no agents of a group there.
    """
    for entrant, prefix in ((WITH_PEOPLE, "with-people-"), (POPULATION, "with-population-")):
        found = [agent.name for agent in study.agents(layout) if agent.name.startswith(prefix)]
        if not found:
            raise WrongUse(f"{study.folder}: no agents {prefix}* on {layout}; train them: pool build human-study")
        yield from ((entrant, f"{study.folder.absolute()}/{layout}/{name}") for name in found)
    for agent in Pool.load(SELF_PLAY_POOL).agents(layout):
        if agent.trained.done == 1:
            yield SELF_PLAY, f"{SELF_PLAY_POOL}/{layout}/{agent.name}"
    yield GREEDY, GREEDY


def play_study(study: Pool, protocols: Sequence[Protocol], pool: str | None = None, workers: int = 1) -> Games:
    """Plays every entrant under every protocol.

    Args:
        study: What `pool build human-study` made.
        protocols: They have the same layouts, and may differ in the start.
        pool: Plays with this pool instead of the protocols'.
        workers: Number of processes.

    Raises:
        PoolError: A pool is missing or damaged.
        WrongUse: The study lacks agents, or the pool does not fit the protocols.
    """
    tasks = []
    for protocol in protocols:
        partners = Pool.load(pool or str(protocol.play.pool))
        check_pool(partners, protocol, protocol.play.layouts)
        home = str(partners.folder.absolute())
        for layout in protocol.play.layouts:
            tasks += [_Task(protocol, home, partners.hash, layout, *who) for who in agents_of(study, layout)]
    played: dict[tuple[str, str, str], NDArray[np.float64]] = {}
    for done, (task, found) in enumerate(map_tasks(_play, tasks, workers), start=1):
        played[task.protocol.play.start, task.layout, task.agent] = found
        if sys.stderr.isatty():
            print(f"\r{done} of {len(tasks)}", end="\n" * (done == len(tasks)), file=sys.stderr, flush=True)
    returns: dict[tuple[str, str, str], list[NDArray[np.float64]]] = defaultdict(list)
    for task in tasks:  # in this order under every protocol, whatever came first: a run is one value over the starts
        start = task.protocol.play.start
        returns[start, task.layout, task.entrant].append(played[start, task.layout, task.agent])
    first = tasks[0]
    met = pool_as_hashed(first.pool, first.pool_sha256)
    names = {layout: [partner.name for partner in _counting(met, layout)] for layout in first.protocol.play.layouts}
    return Games({key: np.stack(runs) for key, runs in returns.items()}, names)


def _counting(pool: Pool, layout: str) -> list[Partner]:
    """Lists the partners that count in a score."""
    return [partner for partner in roster(pool, layout) if partner.kind != FLOOR]


def _play(task: _Task) -> tuple[_Task, NDArray[np.float64]]:
    """Plays one agent from the start states of a score under the same protocol; returns (P, E, K) points."""
    rules, pool = task.protocol.play, pool_as_hashed(task.pool, task.pool_sha256)
    partners = _counting(pool, task.layout)
    hashes = [partner.sha256 for partner in partners]
    shape = len(partners), rules.episodes, len(rules.seats)
    who, episode, place = (axis.ravel() for axis in np.indices(shape))
    seats = np.array(rules.seats, np.int64)[place]
    starts, seeds = np.empty(len(who), np.uint64), np.empty((len(who), 2), np.uint64)
    for index in range(rules.episodes):
        streams, rows = Streams(task.protocol.sha256, rules.salt, 0, task.layout, index), episode == index
        starts[rows] = np.array([streams.start(name) for name in hashes], np.uint64)[who[rows]]
        seeds[rows] = streams.seeds([hashes[partner] for partner in who[rows]], seats[rows])
    with one_thread():
        agent = load_agent(task.agent, task.layout, mode=rules.mode)
        parties = [
            Seated(agent, "the entrant", np.arange(len(who)), seats),
            *seat_partners(partners, who, 1 - seats, pool, rules.mode, task.layout),
        ]
        kitchens = make_kitchens(task.layout, len(who), parties, **rules.kitchens)
        kitchens.reset(seed=starts)
        games = play(kitchens, parties, seeds)
    return task, games.soup_reward.sum(axis=1).reshape(shape)


def main(arguments: Sequence[str] | None = None) -> int:
    """Plays and prints the tables in Markdown; gives the exit code, 2 for wrong use."""
    parser = argparse.ArgumentParser(prog="with_people", description="Plays the study of results/humans-plan.md.")
    parser.add_argument("study", metavar="FOLDER", help="the pool that `overcooked-bench pool build human-study` made")
    parser.add_argument("--pool", help="partners instead of those of the protocols, to try the program out")
    parser.add_argument("--workers", type=int, default=1, help="number of processes (default: 1)")
    given = parser.parse_args(arguments)
    try:
        study, protocols = Pool.load(Path(given.study)), [load_protocol(name) for name in PROTOCOLS]
        print(report(play_study(study, protocols, given.pool, given.workers)))
    except WrongUse as error:
        print(error, file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    from overcooked_bench.baselines.with_people import main as imported  # worker processes find `_play` by this name

    raise SystemExit(imported())
