"""The 0.15-quantile over training seeds of each point of the ordered curve."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation import statistics
from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts
from overcooked_bench.evaluation.metrics.curve import per_repetition as curve
from overcooked_bench.evaluation.metrics.curve import ranks


def per_repetition(cells: Cells, rank: float) -> NDArray[np.float64]:
    """Returns the quantile over training seeds: (1,), or (0,) for a single one."""
    values = curve(cells, rank)
    return statistics.low_quantile(values).reshape(1) if len(values) > 1 else np.empty(0)


METRIC: Final = Metric(
    facts=MetricFacts(name="curve_quantile", label="q0.15 of rank {rank:g}", tables=()),
    per_repetition=per_repetition,
    params=ranks,
    place=31,
)
