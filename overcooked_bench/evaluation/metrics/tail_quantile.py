"""The 0.15-quantile of the return over partners."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation import statistics
from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts


def per_repetition(cells: Cells) -> NDArray[np.float64]:
    """Returns each training seed's quantile over its partners."""
    return statistics.tail_quantile(cells.means)


METRIC: Final = Metric(
    facts=MetricFacts(name="tail_quantile", label="q0.15", tables=()), per_repetition=per_repetition, place=21
)
