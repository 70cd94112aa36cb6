"""How well a layout separates good agents from bad ones, from the entries that played it.

A layout discriminates if scores of different entries are further apart there than their intervals are wide. It is
saturated if most entries are near the top, and says nothing new if it ranks entries as the other layouts do.
"""

from collections.abc import Sequence
from statistics import median, stdev
from typing import Final, NamedTuple

import numpy as np

from overcooked_bench.evaluation.scores import MEAN
from overcooked_bench.leaderboard.site.board import runs_of
from overcooked_bench.leaderboard.site.entries import Entry
from overcooked_bench.leaderboard.site.groups import separate

FEWEST: Final = 3
"""Entries below which nothing is said."""
TOP: Final = 0.9
"""A score from which on an entry is near the top."""
BOTTOM: Final = 0.1
"""A score up to which an entry is near the bottom, the partners' floors."""


class Discrimination(NamedTuple):
    """What the entries of a protocol say about one of its layouts; None where there are too few.

    Attributes:
        values: The score of each entry, ascending.
        spread: Standard deviation between entries.
        half_width: Median of half the width of their 95 % intervals.
        separated: Pairs of methods that are separated there, and all pairs; None if there is none.
        agreement: Rank correlation with the mean of the other layouts.
        cross_play: Median of the points with the pool's partners as a share of the points with a copy of itself.
    """

    values: tuple[float, ...]
    spread: float | None
    half_width: float | None
    separated: tuple[int, int] | None
    agreement: float | None
    cross_play: float | None

    @property
    def ratio(self) -> float | None:
        """The spread in half-widths of an interval."""
        return None if self.spread is None or not self.half_width else self.spread / self.half_width

    @property
    def verdict(self) -> str:
        """Says in words how well the layout discriminates; an empty text if there are too few entries."""
        if self.ratio is None:
            return ""
        if median(self.values) >= TOP:
            return "hardly: most entries are near the top"
        if median(self.values) <= BOTTOM:
            return "among the best entries only: most are near the bottom"
        return "well" if self.ratio >= 3 else "somewhat" if self.ratio >= 1.5 else "hardly: intervals are as wide"


def discrimination(entries: Sequence[Entry], layout: str) -> Discrimination:
    """Computes what entries of the same protocol say about a layout; those that nobody audited do not count."""
    counted = [one for one in entries if one.status not in ("reported", "withdrawn")]
    found = [(one, row) for one in counted if (row := one.scores.find(one.scores.headline, layout=layout))]
    values = sorted(row.value for _, row in found)
    widths = [(row.high - row.low) / 2 for _, row in found if row.low is not None and row.high is not None]
    shares = [share for one, _ in found if (share := _cross_play(one, layout)) is not None]
    enough = len(values) >= FEWEST
    return Discrimination(
        values=tuple(values),
        spread=stdev(values) if enough else None,
        half_width=median(widths) if enough and widths else None,
        separated=_separated([one for one, _ in found], layout),
        agreement=_agreement([one for one, _ in found], layout) if enough else None,
        cross_play=median(shares) if shares else None,
    )


def _cross_play(entry: Entry, layout: str) -> float | None:
    mean, alone = (entry.scores.find(name, layout=layout) for name in (MEAN, "self_play"))
    return mean.value / alone.value if mean is not None and alone is not None and alone.value > 0 else None


def _separated(entries: Sequence[Entry], layout: str) -> tuple[int, int] | None:
    runs = {one.key: runs_of(one, layout) for one in entries if one.scores.kind == "method" and runs_of(one, layout)}
    if len(runs) < 2:
        return None
    groups = separate(dict(sorted(runs.items(), key=lambda pair: -sum(pair[1]) / len(pair[1]))))
    return groups.separated, groups.pairs


def _agreement(entries: Sequence[Entry], layout: str) -> float | None:
    """Returns Spearman's correlation of a layout's scores with the mean of the other layouts'."""
    pairs = []
    for one in entries:
        rows = {name: one.scores.find(one.scores.headline, layout=name) for name in one.scores.settings.play.layouts}
        others = [row.value for name, row in rows.items() if row is not None and name != layout]
        here = rows.get(layout)
        if here is not None and others:
            pairs.append((here.value, sum(others) / len(others)))
    if len(pairs) < FEWEST or any(len(set(side)) < 2 for side in zip(*pairs, strict=True)):
        return None
    from scipy.stats import spearmanr

    return float(np.asarray(spearmanr(*zip(*pairs, strict=True)).statistic))
