"""The mean N with the worst third of the partners, by their weights."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts
from overcooked_bench.evaluation.metrics.n import of_runs
from overcooked_bench.evaluation.statistics import weighted_tail

PART: Final = 1 / 3


def per_repetition(cells: Cells) -> NDArray[np.float64]:
    """Returns each training seed's mean over its own worst partners; (0,) without bounds."""
    values = of_runs(cells)
    return weighted_tail(values, cells.shares, PART) if len(values) else np.empty(0)


METRIC: Final = Metric(
    facts=MetricFacts(name="worst_third", label="worst\nthird", unit="", digits=2, interval=False),
    per_repetition=per_repetition,
    by=("overall", "layout"),
    lowest=-np.inf,
    place=-10,
)
