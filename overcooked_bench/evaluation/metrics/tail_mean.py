"""The mean return with the worst 15 % of the partners."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation import statistics
from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts


def per_repetition(cells: Cells) -> NDArray[np.float64]:
    """Returns each training seed's mean over its own worst partners."""
    return statistics.tail_mean(cells.means)


METRIC: Final = Metric(
    facts=MetricFacts(name="tail_mean", label="worst 15 %", tables=("report",)), per_repetition=per_repetition, place=20
)
