"""The oracle: each partner of a pool met by the best known responder to it, which the pool's bounds name.

No agent knows whom it meets, so the oracle is no agent and is not scored as one. Its normalised score, the mean of
(mean - floor) / (ceiling - floor), is about 1 by construction: ceilings are what these responders reached before. How
far it is from 1 in fresh episodes is the noise that every normalised score has, from episodes and from ceilings.
"""

from collections.abc import Callable, Sequence
from math import hypot, sqrt
from typing import Final, NamedTuple

from overcooked_bench.agents.pools.manifest import PoolError
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Bound, Entry
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.estimate import Estimate, t_interval
from overcooked_bench.evaluation.pools.meeting import play_pairs
from overcooked_bench.evaluation.pools.normalised import partner_shares
from overcooked_bench.evaluation.pools.pairs import points_from
from overcooked_bench.evaluation.pools.players import Player, players_of

PURPOSE: Final = "oracle"


class OracleRow(NamedTuple):
    """What the oracle reached with one partner from one side.

    Attributes:
        partner: The partner's name.
        responder: Reference of the agent that played as the oracle.
        bound: Floor and ceiling.
        weight: Share of the layout's normalised score.
        reached: Points per episode.
    """

    partner: str
    responder: str
    bound: Bound
    weight: float
    reached: Estimate

    @property
    def normalised(self) -> float:
        """0 at the floor and 1 at the ceiling."""
        return (self.reached.value - self.bound.floor) / (self.bound.ceiling - self.bound.floor)

    @property
    def half_width(self) -> float:
        """Half the width of its 95 % interval, from the oracle's episodes and those of the ceiling."""
        low, high = self.reached.interval or (self.reached.value, self.reached.value)
        noise = hypot(high - low, self.bound.high - self.bound.low) / 2
        return noise / (self.bound.ceiling - self.bound.floor)


def play_oracle(
    pool: Pool,
    layout: str,
    episodes: int = 100,
    seed: int = 0,
    workers: int = 1,
    horizon: int = 400,
    on_progress: Callable[[int, int], object] = lambda done, of: None,
) -> list[OracleRow]:
    """Plays the best known responder of each partner and side with it, in episodes that no bound was measured in.

    Args:
        pool: Its bounds were measured; their responders are among its own agents, those of shipped pools, or scripted.
        layout: One of the pool's.
        episodes: Per partner and seat.
        seed: Of start states and random streams.
        workers: Processes.
        horizon: Steps of an episode.
        on_progress: Called with pairs that are done and all pairs.

    Returns:
        One row for each partner and side, by the partners' names.

    Raises:
        PoolError: A bound was not measured, or its responder cannot be found or is not the one that was measured.
    """
    partners = [player for player in players_of(pool, layout) if player.entry.role == "partner"]
    known = _Responders(pool, layout)
    meetings = [(partner, bound, known.find(bound)) for partner in partners for bound in _bounds(pool, partner.entry)]
    players = list({player.reference: player for partner, _, one in meetings for player in (one, partner)}.values())
    index = {player.reference: i for i, player in enumerate(players)}
    pairs = list(dict.fromkeys((index[one.reference], index[partner.reference]) for partner, _, one in meetings))
    played = play_pairs(layout, players, pairs, episodes, seed, workers, horizon, on_progress, PURPOSE)
    shares = partner_shares([partner.entry for partner in partners])
    weights = dict(zip((partner.entry.name for partner in partners), shares.tolist(), strict=True))
    rows = []
    for partner, bound, one in meetings:
        pair = pairs.index((index[one.reference], index[partner.reference]))
        reached = points_from(played.returns[pair], played.sides[pair], bound.side)
        weight = weights[partner.entry.name] / len(partner.entry.bounds or ())
        rows.append(OracleRow(partner.entry.name, one.reference, bound, weight, t_interval(reached, lowest=0)))
    return rows


def oracle_score(rows: Sequence[OracleRow]) -> Estimate:
    """Computes the oracle's normalised score on a layout, with an interval over its episodes and the ceilings'."""
    value = sum(row.weight * row.normalised for row in rows)
    half = sqrt(sum((row.weight * row.half_width) ** 2 for row in rows))
    return Estimate(value, value - half, value + half)


class _Responders:
    """Finds the responders that bounds name, each pool read once."""

    def __init__(self, pool: Pool, layout: str) -> None:
        self._layout, self._pools = layout, {pool.name: pool}

    def find(self, bound: Bound) -> Player:
        where, _, name = bound.responder.rpartition(f"/{self._layout}/")
        if not where and name in SCRIPTED:
            player = Player.scripted(name, self._layout)
        else:
            pool = self._pools.setdefault(where, self._pools.get(where) or Pool.load(where))
            named = {player.entry.name: player for player in players_of(pool, self._layout)}
            if name not in named:
                raise PoolError(f"pool {pool.name!r} has no agent {name!r} on {self._layout}, which a bound names")
            player = named[name]
        if player.sha256 != bound.responder_sha256:
            raise PoolError(f"{bound.responder}: not the agent that the bound was measured with; measure it again")
        return player


def _bounds(pool: Pool, entry: Entry) -> tuple[Bound, ...]:
    if not entry.bounds:
        raise PoolError(f"pool {pool.name!r}: the bounds of {entry.layout}/{entry.name} have not been measured")
    return entry.bounds
