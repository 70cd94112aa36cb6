"""Plays the pairings of one layout: who sits where in which kitchen.

Axes: M moments, R repeats, N kitchens (rows).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Final, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import AgentFactory
from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.isolation.settings import Isolation
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.agents.seated import Seated
from overcooked_bench.agents.seeding import seeded
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.agents.watch import LOADING, calling
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.explaining.continuing import Continued, play_on
from overcooked_bench.evaluation.explaining.moments import STEPS, Moment
from overcooked_bench.evaluation.explaining.reasons import PAIRINGS, REPEATS, Pairing, Soups
from overcooked_bench.evaluation.games.block import EGO
from overcooked_bench.evaluation.games.play import make_kitchens
from overcooked_bench.evaluation.games.roster import pool_as_hashed, roster, seat_policies, seat_scripted
from overcooked_bench.evaluation.games.streams import stream_key
from overcooked_bench.kitchen.layout import MIRRORED, Layout

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.policy import Policy

GREEDY: Final = "greedy"


@dataclass(frozen=True)
class Task:
    """What is to be played on one layout; small enough to be sent anywhere.

    Attributes:
        agent: What finds the scored agent.
        agent_sha256: Hash of what was scored.
        name: What tables call it.
        pool: Folder of the pool.
        pool_sha256: Hash of what was played with.
        mode: How frozen policies act.
        cooking: The kitchens' cooking mode.
        horizon: Steps of an episode.
        salt: What all streams are derived from: the hash of what was played, the score's salt and its seed.
        layout: Where.
        adapted: Whether the agent was given the mirror image.
        moments: M moments.
        isolation: How a submission is isolated, or None.
    """

    agent: str
    agent_sha256: str
    name: str
    pool: str
    pool_sha256: str
    mode: Literal["sample", "greedy"]
    cooking: str
    horizon: int
    salt: str
    layout: str
    adapted: bool
    moments: tuple[Moment, ...]
    isolation: Isolation | None = None


class Row(NamedTuple):
    """One kitchen.

    Attributes:
        moment: Index of the moment that it plays on from.
        pairing: Who plays.
        repeat: From 0.
    """

    moment: int
    pairing: Pairing
    repeat: int


class Played(NamedTuple):
    """What came of a task.

    Attributes:
        task: The task.
        rows: N kitchens: a moment's are neighbours, by pairing, then repeat.
        continued: What was played in them.
    """

    task: Task
    rows: tuple[Row, ...]
    continued: Continued

    def of(self, moment: int, pairing: Pairing) -> list[int]:
        """Lists the kitchens of a moment and a pairing, by repeat."""
        per_moment = len(self.rows) // len(self.task.moments)
        first = moment * per_moment + REPEATS * PAIRINGS.index(pairing)
        return list(range(first, first + repeats(pairing)))

    def soups(self, moment: int) -> Soups:
        """Returns the soups of a moment's pairings."""
        worth = Layout.load(self.task.layout).soup_points
        points = self.continued.points / worth
        return Soups(**{pairing: tuple(points[self.of(moment, pairing)].tolist()) for pairing in PAIRINGS})


def repeats(pairing: Pairing) -> int:
    """Returns how many times a pairing plays on from a moment."""
    return 1 if pairing == GREEDY else REPEATS


def play_pairings(task: Task) -> Played:
    """Plays on from the moments of a layout, all of them in one batch.

    Raises:
        WrongUse: The agent is not the one that was scored, or a partner is not in the pool.
        PoolError: The pool is not the one that was played with, or is damaged.
        SeatedFault: The agent broke the contract.
        UnknownLayout: The agent declines the layout.
    """
    rows = [
        Row(moment, pairing, repeat)
        for moment in range(len(task.moments))
        for pairing in PAIRINGS
        for repeat in range(repeats(pairing))
    ]
    make = _find(task)
    with one_thread(), seeded(stream_key("explain", task.salt, task.layout, "process")):
        parties = [*_entrants(task, rows, make), *_partners(task, rows), *_yardstick(task, rows)]
        kitchens = make_kitchens(task.layout, len(rows), parties, cooking=task.cooking, horizon=task.horizon)
        kitchens.reset(seed=0)
        for index, row in enumerate(rows):
            kitchens.set_state(index, task.moments[row.moment].episode.first_state)
        latest = max(moment.step for moment in task.moments)
        actions = [moment.episode.joint_actions(task.horizon)[:latest] for moment in task.moments]
        recorded = np.stack(actions, axis=1)[:, [row.moment for row in rows]]
        steps = np.array([task.moments[row.moment].step for row in rows])
        return Played(task, tuple(rows), play_on(kitchens, parties, _seeds(task, rows), recorded, steps, STEPS))


def _find(task: Task) -> AgentFactory:
    advice = "name the agent that was scored with --agent"
    try:
        with calling("loading", LOADING):
            entrant = find(task.agent, mode=task.mode, isolation=task.isolation)
    except AgentError as error:
        raise WrongUse(f"{error}; {advice}") from error
    if entrant.sha256 != task.agent_sha256:
        raise WrongUse(
            f"{task.agent} is not the agent that was scored (SHA-256 {task.agent_sha256[:12]}… then, "
            f"{entrant.sha256[:12]}… here); {advice}, as it was then, or score it again"
        )
    return entrant.make


def _entrants(task: Task, rows: Sequence[Row], make: AgentFactory) -> Iterator[Seated]:
    """Makes the scored agent, once for each training seed."""
    layout = task.layout.removesuffix(MIRRORED) if task.adapted else task.layout
    seeds = np.array([task.moments[row.moment].episode.training_seed for row in rows])
    who = _who(task, rows, "agent")
    for training_seed in np.unique(seeds).tolist():
        kitchens, seats = np.nonzero(who & (seeds == training_seed)[:, None])
        if len(kitchens):
            with calling("make_agent", LOADING):
                agent = make(layout, training_seed)
            yield Seated(mirrored(agent) if task.adapted else agent, EGO, kitchens, seats)


def _partners(task: Task, rows: Sequence[Row]) -> Iterator[Seated]:
    """Makes the agents that play partners: one for each scripted one, and one of each architecture and seat."""
    pool = pool_as_hashed(task.pool, task.pool_sha256)
    entries = {partner.sha256: partner.entry for partner in roster(pool, task.layout)}
    wanted = list(dict.fromkeys(moment.episode.partner_sha256 for moment in task.moments))
    if strange := [one for one in wanted if one not in entries]:
        raise WrongUse(f"the pool {pool.name!r} has no partner with SHA-256 {strange[0][:12]}… on {task.layout}")
    of_row = np.array([wanted.index(task.moments[row.moment].episode.partner_sha256) for row in rows])
    who = np.where(_who(task, rows, "partner"), of_row[:, None], -1)
    policies: dict[int, Policy] = {}
    for index, sha256 in enumerate(wanted):
        entry = entries[sha256]
        if entry.training is not None:
            policies[index] = pool.policy(entry.layout, entry.name)
        else:
            kitchens, seats = np.nonzero(who == index)
            yield seat_scripted(entry, kitchens, seats, task.layout)
    for seat in range(2):
        yield from seat_policies(policies, who[:, seat], np.full(len(rows), seat), task.mode, task.layout)


def _yardstick(task: Task, rows: Sequence[Row]) -> Iterator[Seated]:
    kitchens, seats = np.nonzero(_who(task, rows, GREEDY))
    yield Seated(SCRIPTED[GREEDY].factory(task.layout), GREEDY, kitchens, seats)


def _who(task: Task, rows: Sequence[Row], who: Literal["agent", "partner", "greedy"]) -> NDArray[np.bool_]:
    """Returns on which seats somebody sits: (N, 2) bool."""
    found = np.zeros((len(rows), 2), np.bool_)
    for index, row in enumerate(rows):
        if row.pairing == who:
            found[index] = True
        elif row.pairing == "pair" and who != GREEDY:
            seat = task.moments[row.moment].episode.seat
            found[index, seat if who == "agent" else 1 - seat] = True
    return found


def _seeds(task: Task, rows: Sequence[Row]) -> NDArray[np.uint64]:
    """Returns the seed of each chef, (N, 2): it depends on what was played, the moment and who plays, nothing else."""
    seeds = np.empty((len(rows), 2), np.uint64)
    for index, (number, pairing, repeat) in enumerate(rows):
        episode, step = task.moments[number]
        key = episode.layout, episode.training_seed, episode.partner_sha256, episode.episode, episode.seat, step
        for chef in range(2):
            seeds[index, chef] = stream_key("explain", task.salt, *key, pairing, repeat, chef)
    return seeds
