"""The mean return over partners, seats and start states."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts


def per_repetition(cells: Cells) -> NDArray[np.float64]:
    """Returns the mean return of each training seed, or of each episode block of the only one."""
    return cells.per_repetition(cells.returns)


METRIC: Final = Metric(
    facts=MetricFacts(name="mean", label="mean [95 %]"),
    per_repetition=per_repetition,
    by=("overall", "layout", "seat", "stratum", "partner", "partner and seat"),
    place=0,
)
