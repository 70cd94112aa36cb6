"""The share of partners with whom the agent reaches a number of soups."""

from collections.abc import Iterable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.estimate import Estimate, t_interval
from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts, Params
from overcooked_bench.evaluation.protocol import Report
from overcooked_bench.evaluation.statistics import reached, threshold


def levels(report: Report, cells: Cells) -> Iterable[Params]:
    """Lists the thresholds of the protocol, in soups."""
    return [{"soups": soups} for soups in report.thresholds]


def of_partners(cells: Cells, soups: float) -> NDArray[np.float64]:
    """Returns (S, P), 1 for each partner with whom a training seed reaches the level, else 0."""
    return np.asarray(cells.means >= soups * cells.soup_points, np.float64)


def per_repetition(cells: Cells, soups: float) -> NDArray[np.float64]:
    """Returns each training seed's share of partners with a mean return of so many soups."""
    return reached(cells.means, soups * cells.soup_points) / len(cells.partners)


def interval(values: NDArray[np.float64], cells: Cells, soups: float) -> Estimate:
    """Runs from the partners that reach the level for certain to those that may, if there is one training seed only."""
    if len(values) > 1:
        return t_interval(values, 0, 1)
    partners = len(cells.partners)
    found = threshold(cells.returns.mean(axis=3), soups * cells.soup_points).reached
    if found.interval is None:
        return Estimate(found.value / partners)
    return Estimate(found.value / partners, found.interval[0] / partners, found.interval[1] / partners)


METRIC: Final = Metric(
    facts=MetricFacts(
        name="threshold",
        label="≥{soups:g}",
        unit="share",
        digits=0,
        interval=False,
        note="≥n: share of partners with a mean return of at least n soups.",
    ),
    per_repetition=per_repetition,
    params=levels,
    by=("overall", "layout", "seat", "side", "stratum", "home", "partner"),
    of_partners=of_partners,
    counts=True,
    interval=interval,
    highest=1.0,
    place=10,
)
