"""The scores of entrants: normalised with the pool and its parts, and plain means with other pools.

Axes: A entrants, P partners, E episodes from each seat, K = 2 seats of the entrant, S sides.
"""

from collections.abc import Mapping, Sequence
from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.evaluation.pools.normalised import normalised, partner_shares, side_means, weighted_mean
from overcooked_bench.evaluation.pools.pairs import Played
from overcooked_bench.evaluation.pools.players import Player

from .entrants import tied

HUMAN: Final = "human"
"""The stratum of the pool that is left out where scores are held against other people's proxies."""
WHOLE: Final = "N"
TWIN: Final = "N with the twin"
WITHOUT: Final = "N without {}"
ONLY: Final = "N with {} alone"
PLAIN: Final = "plain mean without human"
SELF_PLAY: Final = "self-play"
MEAN: Final = "mean with {}"

Scores = dict[str, NDArray[np.float64]]
"""Name -> (A,) scores; NaN for entrants that are tied to one of the partners."""


class Cast(NamedTuple):
    """The pools of one layout, as players.

    Attributes:
        entrants: A of them.
        pool: The pool's partners.
        twin: The twin's; none without a twin.
        others: By name, other pools' partners, such as those of `human-test`.
    """

    entrants: Sequence[Player]
    pool: Sequence[Player]
    twin: Sequence[Player]
    others: Mapping[str, Sequence[Player]]


class Meetings(NamedTuple):
    """What the entrants reach.

    Attributes:
        pool: (A, P, E, K) with the pool's partners.
        twin: With the twin's; None without a twin.
        others: By name, with other pools' partners.
        copies: (A, E, K) with copies of themselves.
    """

    pool: Played
    twin: Played | None
    others: Mapping[str, Played]
    copies: NDArray[np.float64]


def all_scores(cast: Cast, met: Meetings, episodes: Sequence[int] | slice = slice(None)) -> Scores:
    """Computes every score of the entrants.

    Args:
        cast: Who met.
        met: What they reached.
        episodes: The episodes to use, all by default.
    """
    entrants = [player.entry for player in cast.entrants]
    partners = [player.entry for player in cast.pool]
    strata = list(dict.fromkeys(entry.stratum for entry in partners))
    found = {WHOLE: _normalised(entrants, partners, met.pool, episodes)}
    for stratum in strata if len(strata) > 1 else ():
        for name, chosen in ((WITHOUT, False), (ONLY, True)):
            part = [entry.stratum if (entry.stratum == stratum) is chosen else "" for entry in partners]
            found[name.format(stratum)] = _normalised(entrants, partners, met.pool, episodes, part)
    if met.twin is not None:
        found[TWIN] = _normalised(entrants, [player.entry for player in cast.twin], met.twin, episodes)
    people = [entry.stratum == HUMAN for entry in partners]
    kept = np.flatnonzero(~np.array(people)) if not all(people) else np.arange(len(partners))
    found[PLAIN] = _plain(entrants, [partners[index] for index in kept], met.pool.returns[:, kept], episodes)
    for name, players in cast.others.items():
        found[MEAN.format(name)] = _plain(
            entrants, [player.entry for player in players], met.others[name].returns, episodes
        )
    found[SELF_PLAY] = np.asarray(met.copies[:, episodes].mean(axis=(1, 2)))
    return found


def _normalised(
    entrants: Sequence[Entry],
    partners: Sequence[Entry],
    played: Played,
    episodes: Sequence[int] | slice,
    strata: Sequence[str] | None = None,
) -> NDArray[np.float64]:
    """Returns the (A,) scores N; partners whose stratum is "" in `strata` are left out."""
    used = [index for index in range(len(partners)) if strata is None or strata[index]]
    chosen = [partners[index] for index in used]
    values = normalised(
        side_means(played.returns[:, used][:, :, episodes], played.sides[:, used][:, :, episodes]), chosen
    )
    return _untied(entrants, chosen, weighted_mean(values, partner_shares(chosen)))


def _plain(
    entrants: Sequence[Entry],
    partners: Sequence[Entry],
    returns: NDArray[np.float64],
    episodes: Sequence[int] | slice,
) -> NDArray[np.float64]:
    return _untied(entrants, partners, np.asarray(returns[:, :, episodes].mean(axis=(1, 2, 3))))


def _untied(entrants: Sequence[Entry], partners: Sequence[Entry], scores: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.where([tied(entrant, partners) for entrant in entrants], np.nan, scores)
