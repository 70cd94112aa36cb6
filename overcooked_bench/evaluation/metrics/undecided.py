"""The number of partners whose mean is too close to a threshold to call."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts
from overcooked_bench.evaluation.metrics.threshold import levels
from overcooked_bench.evaluation.statistics import threshold


def per_repetition(cells: Cells, soups: float) -> NDArray[np.float64]:
    """Counts the partners whose mean is within two standard errors of the level: (1,), or (0,) without an error."""
    count = threshold(cells.returns.mean(axis=3), soups * cells.soup_points).undecided
    return np.array([] if count is None else [count], np.float64)


METRIC: Final = Metric(
    facts=MetricFacts(name="undecided", label="near {soups:g}", unit="partners", digits=0, tables=()),
    per_repetition=per_repetition,
    params=levels,
    place=11,
)
