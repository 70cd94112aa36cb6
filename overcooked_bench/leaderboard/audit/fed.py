"""Shows agents what they saw when a result was played, and counts how often they act as recorded.

The games follow the recorded joint actions whatever is answered. Axes: N rows (cells), T steps.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.catalogue import find_unchanged
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.seated import Seated, Views
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.evaluation.games.block import EGO, Block, met
from overcooked_bench.evaluation.games.episode import Episode
from overcooked_bench.evaluation.games.play import make_kitchens
from overcooked_bench.evaluation.games.roster import ITSELF, SELF, pool_as_hashed, roster, seat_partners
from overcooked_bench.kitchen.layout import MIRRORED

LEAST_AGREEMENT = 0.995


class Feeding(NamedTuple):
    """What the scored agent is to be shown.

    Attributes:
        block: The block of the episodes.
        episodes: N recorded ones, in the order of the agent's rows.
    """

    block: Block
    episodes: tuple[Episode, ...]


class Fed(NamedTuple):
    """How an agent acted.

    Attributes:
        same: Steps in which it acted as recorded.
        steps: All steps.
        fault: What went wrong, or None.
    """

    same: int
    steps: int
    fault: str | None = None


def feed_agent(feeding: Feeding) -> Fed:
    """Shows the scored agent its recorded observations, all rows in one batch; run it where its code may run."""
    block, episodes = feeding
    steps = len(episodes) * block.protocol.play.horizon
    try:
        with one_thread():
            entrant = find_unchanged(block.agent, block.agent_sha256, block.protocol.play.mode, block.isolation)
            layout = block.layout.removesuffix(MIRRORED) if block.adapted else block.layout
            agent = entrant.make(layout, block.training_seed)
            seats = np.array([episode.seat for episode in episodes])
            party = Seated(mirrored(agent) if block.adapted else agent, EGO, np.arange(len(episodes)), seats)
            same = follow(block, episodes, [party])
    except OvercookedBenchError as error:
        return Fed(0, steps, str(error))
    return Fed(int(same[np.arange(len(episodes)), seats].sum()), steps)


def feed_partners(block: Block, episodes: Sequence[Episode]) -> Fed:
    """Shows the partners of whole blocks what they saw; copies of the scored agent are left out."""
    pool, play = pool_as_hashed(block.pool, block.pool_sha256), block.protocol.play
    partners = roster(pool, block.layout, play.per_stratum)
    index = {partner.name: number for number, partner in enumerate(partners)}
    rows = [episode for episode in episodes if episode.kind != SELF and episode.partner in index]
    who = np.array([index[episode.partner] for episode in rows])
    seats = np.array([1 - episode.seat for episode in rows])
    same = follow(block, rows, seat_partners(partners, who, seats, pool, play.mode, block.layout))
    return Fed(int(same[np.arange(len(rows)), seats].sum()), len(rows) * play.horizon)


def follow(block: Block, episodes: Sequence[Episode], parties: Sequence[Seated]) -> NDArray[np.int64]:
    """Plays recorded episodes again and asks agents at every step what they would do.

    Args:
        block: The block of the episodes.
        episodes: N of them, one for each row.
        parties: Who is asked; their answers change nothing.

    Returns:
        (N, 2) number of steps in which the agent on a seat acts as recorded; 0 where nobody is asked.
    """
    n, play = len(episodes), block.protocol.play
    kitchens = make_kitchens(block.layout, n, parties, **play.kitchens)
    for row, episode in enumerate(episodes):
        kitchens.set_state(row, episode.first_state)
    joint = np.stack([episode.joint_actions(play.horizon) for episode in episodes], axis=1).astype(np.int64)
    seeds = _seeds(block, episodes)
    for party in parties:
        party.reset(kitchens.layout.name, seeds[party.rows, party.seats])
        party.fit(kitchens)
    views, same = Views(kitchens), np.zeros((n, 2), np.int64)
    for step in range(play.horizon):
        views.renew()
        for party in parties:
            where = party.rows, party.seats
            same[where] += party.act(views.of(party)) == joint[step][where]
        kitchens.step(joint[step])
    return same


def _seeds(block: Block, episodes: Sequence[Episode]) -> NDArray[np.uint64]:
    """Returns (N, 2) the seeds that the chefs had, by seat."""
    everybody = met(block, pool_as_hashed(block.pool, block.pool_sha256))
    seats = sorted(block.protocol.play.seats)
    hands = [(one.name, ITSELF if one.kind == SELF else one.sha256, seat) for one in everybody for seat in seats]
    known: dict[tuple[int, str, int], NDArray[np.uint64]] = {}
    for number in {episode.episode for episode in episodes}:
        streams = block.streams(number)
        dealt = [hands[k] for k in streams.order(len(hands))]
        seeds = streams.seeds([sha256 for _, sha256, _ in dealt], np.array([seat for _, _, seat in dealt]))
        known |= {(number, name, seat): own for (name, _, seat), own in zip(dealt, seeds, strict=True)}
    return np.stack([known[episode.episode, episode.partner, episode.seat] for episode in episodes])
