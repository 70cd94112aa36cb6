"""The share of steps in which the other chef keeps a chef out of a floor cell."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.conduct import BOTH, of_chef
from overcooked_bench.evaluation.metric import Metric, MetricFacts


def of_partners(cells: Cells, chef: float) -> NDArray[np.float64]:
    """Returns (R, P) of the scored agent, chef 0, or of its partner, chef 1; (0, P) if games were not replayed."""
    return of_chef(cells, "blocked", chef)


def per_repetition(cells: Cells, chef: float) -> NDArray[np.float64]:
    """Returns the mean of each training seed, or of each episode block of the only one."""
    return np.asarray(of_partners(cells, chef).mean(axis=1))


METRIC: Final = Metric(
    facts=MetricFacts(name="blocked", label="{chef:own|partner's} steps blocked", unit="share", digits=0, tables=()),
    per_repetition=per_repetition,
    params=lambda report, cells: BOTH,
    by=("overall", "layout", "partner"),
    of_partners=of_partners,
    highest=1.0,
    place=44,
)
