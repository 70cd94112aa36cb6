"""Ordered curves and the table that is read from them: numbers alone, without playing.

A row is one agent of an entrant: what it reaches with each partner, in ascending order. A row of n partners has its
ceil(x n)-th smallest number at a share x of them, so that rows of unequal length can be summarised.

Axes: R rows of an entrant, X shares of the partners, D draws.

Source: the thesis, 7.3 to 7.5 and Table 7.3.
"""

from collections.abc import Sequence
from math import ceil
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.evaluation.protocol import OrderedReport

SHARES: Final = tuple(round(0.01 * percent, 2) for percent in range(1, 101))
"""Shares of the partners at which curves are drawn."""

THESIS_ROWS: Final = 3
"""Rows of a population's configuration in most figures of the thesis, where self-play has 30."""
THESIS_FINALS: Final = 2
"""Final agents of a population, of which the thesis shows the one that reaches more with the self-play agents."""
THESIS_EFFECT: Final = 0.117
"""The largest gain over self-play in the column "Average" of its Table 7.3: L0, .380 against .263."""

_DRAWS: Final = 2000


class Row(msgspec.Struct, frozen=True):
    """One agent with its partners, in ascending order of what they reach.

    Attributes:
        agent: Reference of the agent.
        partners: References of the partners.
        means: Points per episode, over episodes and both seats.
    """

    agent: str
    partners: tuple[str, ...]
    means: tuple[float, ...]

    def at(self, shares: Sequence[float]) -> NDArray[np.float64]:
        """Returns (X,) the ordered curve at shares of the partners."""
        return np.asarray(self.means)[[max(1, ceil(round(x * len(self.means), 9))) - 1 for x in shares]]


class Curve(msgspec.Struct, frozen=True, kw_only=True):
    """An entrant's ordered curve at `SHARES` of the partners, in points per episode, over its rows.

    Attributes:
        entrant: Its name.
        rows: Its agents.
        mean: The mean over rows.
        band: Two quantiles around it.
        quantile: The low quantile, the worst-case view.
        quantile_band: Two quantiles around that.
    """

    entrant: str
    rows: tuple[Row, ...]
    mean: tuple[float, ...]
    band: tuple[tuple[float, ...], tuple[float, ...]]
    quantile: tuple[float, ...]
    quantile_band: tuple[tuple[float, ...], tuple[float, ...]]


class Line(msgspec.Struct, frozen=True, kw_only=True):
    """A line of the table: the low quantile over rows at some shares of the partners, as a part of the maximum.

    Attributes:
        entrant: Who.
        rows: Rows that the quantile is over.
        values: One for each share of the partners.
        average: Their mean.
        drawn: Whether it is the mean over draws of so many rows of self-play agents.
        chosen: Whether each row is the better of `THESIS_FINALS`.
    """

    entrant: str
    rows: int
    values: tuple[float, ...]
    average: float
    drawn: bool = False
    chosen: bool = False


def curve(entrant: str, rows: Sequence[Row], rule: OrderedReport) -> Curve:
    """Summarises rows at every share of the partners."""
    values = np.stack([row.at(SHARES) for row in rows])

    def over_rows(quantile: float) -> tuple[float, ...]:
        return _told(np.quantile(values, quantile, axis=0))

    low, high = (over_rows(quantile) for quantile in rule.band)
    least, most = (over_rows(quantile) for quantile in rule.quantile_band)
    return Curve(
        entrant=entrant,
        rows=tuple(rows),
        mean=_told(values.mean(axis=0)),
        band=(low, high),
        quantile=over_rows(rule.quantile),
        quantile_band=(least, most),
    )


def line(entrant: str, rows: Sequence[Row], rule: OrderedReport, maximum: float) -> Line:
    """Reads the line of an entrant.

    Args:
        entrant: Its name.
        rows: Its agents, all of them.
        rule: Which quantile, at which shares of the partners.
        maximum: Points that count as 1.
    """
    values = np.stack([row.at(rule.positions) for row in rows])
    found = np.quantile(values, rule.quantile, axis=0) / maximum
    return Line(entrant=entrant, rows=len(rows), values=_told(found), average=_mean(found))


def as_few(
    entrant: str, rows: Sequence[Row], rule: OrderedReport, maximum: float, few: int, of: int = 1
) -> Line | None:
    """Reads the line that the same agents would have if there were only a few of them: what reporting alone does.

    The thesis compares 30 rows of self-play agents with 3 rows of a population, each the better of two final agents.
    The 0.15 quantile of 3 values is higher than that of 30 on average, and the better of two reaches more than either.

    Args:
        entrant: Its name.
        rows: Its agents, all of them.
        rule: Which quantile, at which shares of the partners.
        maximum: Points that count as 1.
        few: Rows that are drawn, without replacement.
        of: Agents that a row is chosen among: the one of the greatest mean.

    Returns:
        The mean over draws; None if there are not more agents than are drawn.
    """
    if few * of >= len(rows):
        return None
    values = np.stack([row.at(rule.positions) for row in rows])
    means = np.array([np.mean(row.means) for row in rows])
    shuffled = np.random.default_rng(0).permuted(np.tile(np.arange(len(rows)), (_DRAWS, 1)), axis=1)
    drawn = shuffled[:, : few * of].reshape(_DRAWS, few, of)
    best = np.take_along_axis(drawn, means[drawn].argmax(axis=2)[..., None], axis=2)[..., 0]
    found = np.quantile(values[best], rule.quantile, axis=1).mean(axis=0) / maximum
    return Line(entrant=entrant, rows=few, values=_told(found), average=_mean(found), drawn=True, chosen=of > 1)


def averaged(lines: Sequence[Line]) -> Line:
    """Returns the mean of the lines of one entrant in several figures, as Table 7.3 has it."""
    values = np.array([one.values for one in lines]).mean(axis=0)
    return Line(
        entrant=lines[0].entrant,
        rows=min(one.rows for one in lines),
        values=_told(values),
        average=_mean(values),
        drawn=lines[0].drawn,
        chosen=any(one.chosen for one in lines),
    )


def _told(values: ArrayLike) -> tuple[float, ...]:
    return tuple(round(float(value), 4) for value in np.asarray(values))


def _mean(values: NDArray[Any]) -> float:
    return round(float(values.mean()), 4)
