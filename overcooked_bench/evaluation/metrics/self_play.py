"""The return of the scored agent with a copy of itself."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts


def per_repetition(cells: Cells) -> NDArray[np.float64]:
    """Returns the mean of each training seed, or the episodes of the only one; (0,) if it did not play with itself."""
    if cells.self_play is None:
        return np.empty(0)
    return np.asarray(cells.self_play.mean(axis=1) if len(cells.self_play) > 1 else cells.self_play[0])


METRIC: Final = Metric(
    facts=MetricFacts(name="self_play", label="with\nitself", interval=False),
    per_repetition=per_repetition,
    by=("overall", "layout"),
    place=25,
)
