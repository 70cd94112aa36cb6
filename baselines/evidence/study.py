"""Plays what is missing and sums everything up: one `LayoutRecord` per layout.

Axes: A entrants, P partners, E episodes from each seat, K = 2 seats.
"""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.pools.matrix import agreement
from overcooked_bench.evaluation.pools.normalised import partner_shares
from overcooked_bench.evaluation.pools.pairs import Played
from overcooked_bench.evaluation.pools.similarity import effective_number, similarity

from .components import components, shares
from .entrants import choose_entrants, family, partners_of, recipe
from .entries import score_entries
from .played import PlayedPairs
from .records import EntrantRecord, Evidence, LayoutRecord, PartnerRecord, PoolRecord
from .scores import Cast, Meetings, Scores, all_scores
from .validity import correlations, reliabilities

ALL: Final = "all"
"""The name of the whole pool among its strata."""


@dataclass(frozen=True)
class Given:
    """Who plays.

    Attributes:
        pool: The pool that the evidence is about; its manifest holds bounds.
        twin: A pool of the same configuration and another salt.
        others: By name, the pools whose mean returns scores are held against.
        sources: The pools that entrants come from.
        entries: By name, the training runs of shipped entries, in a pool's format.
    """

    pool: Pool
    twin: Pool | None
    others: Mapping[str, Pool]
    sources: Sequence[Pool]
    entries: Mapping[str, Pool]

    @property
    def known(self) -> tuple[Pool, ...]:
        """All pools."""
        twin = () if self.twin is None else (self.twin,)
        return self.pool, *twin, *self.others.values(), *self.sources, *self.entries.values()


def evidence(given: Given, layouts: Sequence[str], played: PlayedPairs) -> Evidence:
    """Gathers the evidence about a pool.

    Args:
        given: Who plays.
        layouts: Of the pool.
        played: Plays, and remembers.

    Raises:
        WrongUse: A partner has no bounds, a pool no partners on a layout, or there are no entrants.
        PoolError: A pool was changed while it was played.
    """
    records, ranked = [], []
    for layout in layouts:
        record, families, scores = _layout(given, layout, played)
        records.append(record)
        ranked.append((families, scores))
    strata = list(dict.fromkeys(partner.stratum for record in records for partner in record.partners))
    return Evidence(
        pool=_pool(given.pool),
        twin=None if given.twin is None else _pool(given.twin),
        entrants_of=tuple(map(_pool, given.sources)),
        episodes=played.episodes,
        layouts=tuple(records),
        pooled=tuple(correlations(ranked, strata)),
    )


def _layout(given: Given, layout: str, played: PlayedPairs) -> tuple[LayoutRecord, list[str], Scores]:
    pool, twin = partners_of(given.pool, layout), [] if given.twin is None else partners_of(given.twin, layout)
    others = {name: partners_of(other, layout) for name, other in given.others.items()}
    for name, players in (("pool", pool), *others.items()):
        if not players:
            raise WrongUse(f"the pool {given.pool.name if name == 'pool' else name} has no partners on {layout}")
    partners = [player.entry for player in pool]
    for entry in [*partners, *(player.entry for player in twin)]:
        if not entry.bounds:
            raise WrongUse(
                f"{layout}/{entry.name} has no floor and ceiling in its pool's manifest; give a pool that has "
                "them, such as v1"
            )
    cast = Cast(choose_entrants(layout, given.sources, partners), pool, twin, others)
    if not cast.entrants:
        raise WrongUse(f"{layout}: no entrant that is not tied to the pool; give other pools with --candidates")
    met = Meetings(
        pool=played.matrix(layout, cast.entrants, pool),
        twin=played.matrix(layout, cast.entrants, twin) if twin else None,
        others={name: played.matrix(layout, cast.entrants, players) for name, players in others.items()},
        copies=played.pairs(layout, [(player, player) for player in cast.entrants]).returns,
    )
    scores = all_scores(cast, met)
    halves = [all_scores(cast, met, range(first, played.episodes, 2)) for first in range(min(2, played.episodes))]
    families = [family(player) for player in cast.entrants]
    strata = list(dict.fromkeys(entry.stratum for entry in partners))
    variance, variance_points = _variance(cast, met.pool)
    means = _seat_means(played.matrix(layout, pool, pool).returns)
    found = agreement(means, [entry.lineage for entry in partners])
    record = LayoutRecord(
        layout=layout,
        partners=tuple(_partners(partners, means)),
        cross_play=tuple(tuple(round(value, 2) for value in row) for row in means.tolist()),
        self_play=found.self_play,
        strangers=found.cross_play,
        ratio=found.ratio,
        effective=_effective(partners, means),
        values=_values(partners),
        combinations=dict(Counter(entry.convention for entry in partners if entry.convention).most_common()),
        entrants=tuple(_entrants(cast, families, scores)),
        variance=variance,
        variance_points=variance_points,
        reliability=reliabilities(*halves) if len(halves) == 2 else {},
        correlations=tuple(correlations([(families, scores)], strata)),
        entries=tuple(score_entries(layout, given.entries, (pool, twin), given.known, played)),
    )
    return record, families, scores


def _seat_means(returns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns (P, P) means by seat, row: seat 0, from (P, P, E, K) returns by the row's seat."""
    by_seat = returns.mean(axis=2)
    return np.asarray((by_seat[:, :, 0] + by_seat[:, :, 1].T) / 2)


def _partners(partners: Sequence[Entry], means: NDArray[np.float64]) -> list[PartnerRecord]:
    weights = partner_shares(partners)
    return [
        PartnerRecord(
            name=entry.name,
            stratum=entry.stratum,
            codebase=entry.training.codebase if entry.training else None,
            share=float(weights[index]),
            convention=entry.convention,
            floors=tuple(bound.floor for bound in entry.bounds or ()),
            ceilings=tuple(bound.ceiling for bound in entry.bounds or ()),
            with_itself=float(means[index, index]),
        )
        for index, entry in enumerate(partners)
    ]


def _effective(partners: Sequence[Entry], means: NDArray[np.float64]) -> dict[str, float]:
    ceilings = np.array([np.mean([bound.ceiling for bound in entry.bounds or ()]) for entry in partners])
    strata = np.array([entry.stratum for entry in partners])
    found = {}
    for name in (*dict.fromkeys(strata.tolist()), ALL):
        here = np.flatnonzero((strata == name) | (name == ALL))
        found[name] = effective_number(similarity(means[np.ix_(here, here)], ceilings[here]))
    return found


def _values(partners: Sequence[Entry]) -> dict[str, int]:
    """Counts the partners with each value of a convention such as "onions=top, dishes=bottom", axis by axis."""
    counts = Counter(value for entry in partners for value in (entry.convention or "").split(", ") if value)
    return dict(sorted(counts.items(), key=lambda item: (item[0].split("=")[0], -item[1], item[0])))


def _variance(cast: Cast, met: Played) -> tuple[dict[str, float | None], dict[str, float | None]]:
    if met.returns.shape[2] < 2:
        return {}, {}
    found = components(*met, [recipe(player) for player in cast.entrants])
    shown = shares(found), found
    parts = [{name: value if np.isfinite(value) else None for name, value in one.items()} for one in shown]
    return parts[0], parts[1]


def _entrants(cast: Cast, families: Sequence[str], scores: Scores) -> list[EntrantRecord]:
    return [
        EntrantRecord(
            reference=player.reference,
            family=families[index],
            recipe=recipe(player),
            scores={
                name: round(float(values[index]), 4) for name, values in scores.items() if np.isfinite(values[index])
            },
        )
        for index, player in enumerate(cast.entrants)
    ]


def _pool(pool: Pool) -> PoolRecord:
    return PoolRecord(name=pool.name, sha256=pool.hash)
