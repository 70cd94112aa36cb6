"""The mean return over partners, seats and start states."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.estimators import rounding_variance
from overcooked_bench.evaluation.metric import Metric, MetricFacts


def of_partners(cells: Cells) -> NDArray[np.float64]:
    """Returns (R, P) mean returns with each partner."""
    return cells.per_partner(cells.returns)


def per_repetition(cells: Cells) -> NDArray[np.float64]:
    """Returns the mean return of each training seed, or of each episode block of the only one."""
    return cells.per_repetition(cells.returns)


def rounding(cells: Cells) -> float:
    """Returns the variance of a block's mean with the only partner that whole soups make."""
    return rounding_variance(cells.soup_points, len(cells.seats))


METRIC: Final = Metric(
    facts=MetricFacts(name="mean", label="mean [95 %]"),
    per_repetition=per_repetition,
    by=("overall", "layout", "seat", "side", "stratum", "home", "partner", "partner and seat"),
    of_partners=of_partners,
    rounding=rounding,
    place=0,
)
