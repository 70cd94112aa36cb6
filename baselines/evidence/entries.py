"""Scores what anybody would try first: shipped entries, `greedy`, and an oracle that knows who its partner is.

Axes: P partners, S sides.
"""

from collections.abc import Mapping, Sequence
from typing import Final

import numpy as np

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.evaluation.pools.normalised import normalised, partner_shares, side_means, weighted_mean
from overcooked_bench.evaluation.pools.players import Player, players_of

from .entrants import partners_of, scripted_players
from .played import PlayedPairs
from .records import EntryRecord

GREEDY: Final = "greedy"
ORACLE: Final = "oracle"


def score_entries(
    layout: str,
    entries: Mapping[str, Pool],
    partners: tuple[Sequence[Player], Sequence[Player]],
    known: Sequence[Pool],
    played: PlayedPairs,
) -> list[EntryRecord]:
    """Scores the entries with the pool and the twin; partners that are the entry itself are left out.

    Args:
        layout: Where.
        entries: By name, their training runs.
        partners: Of the pool, and of the twin; none of the second without a twin.
        known: Pools among whose agents the best known responders are looked for; the oracle is left out if one is in
            none of them.
        played: Plays, and remembers.
    """
    who = {GREEDY: [Player.scripted(GREEDY, layout)]}
    who |= {name: partners_of(pool, layout) for name, pool in entries.items()}
    found = []
    for name, runs in who.items():
        if runs:
            pool, twin = (_mean([_score(layout, run, them, played) for run in runs if them]) for them in partners)
            assert pool is not None  # a pool without partners is refused before
            found.append(EntryRecord(name=name, runs=len(runs), pool=pool, twin=twin))
    responders = {player.sha256: player for pool in known for player in players_of(pool, layout)}
    responders |= {player.sha256: player for player in scripted_players(layout)}
    pool, twin = (_oracle(layout, them, responders, played) for them in partners)
    return [*found, *([] if pool is None else [EntryRecord(name=ORACLE, runs=1, pool=pool, twin=twin)])]


def _mean(scores: Sequence[float]) -> float | None:
    return float(np.mean(scores)) if scores else None


def _score(layout: str, run: Player, partners: Sequence[Player], played: PlayedPairs) -> float:
    met = played.matrix(layout, [run], partners)
    used = [index for index, player in enumerate(partners) if player.sha256 != run.sha256]
    kept = [partners[index].entry for index in used]
    values = normalised(side_means(met.returns[:, used], met.sides[:, used]), kept)
    return float(weighted_mean(values, partner_shares(kept))[0])


def _oracle(
    layout: str, partners: Sequence[Player], responders: Mapping[str, Player], played: PlayedPairs
) -> float | None:
    """Scores an agent that meets each partner, from each side, as the best known responder to it."""
    bounds = [(index, bound) for index, player in enumerate(partners) for bound in player.entry.bounds or ()]
    if not bounds or any(bound.responder_sha256 not in responders for _, bound in bounds):
        return None
    met = played.pairs(layout, [(responders[bound.responder_sha256], partners[index]) for index, bound in bounds])
    means = side_means(met.returns[:, None], met.sides[:, None])
    values = np.full((1, len(partners), means.shape[2]), np.nan)
    for row, (index, bound) in enumerate(bounds):
        values[0, index, bound.side] = means[row, 0, bound.side]
    entries: list[Entry] = [player.entry for player in partners]
    return float(weighted_mean(normalised(values, entries), partner_shares(entries))[0])
