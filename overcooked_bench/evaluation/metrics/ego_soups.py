"""Soups per episode that the scored agent delivers."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts


def of_partners(cells: Cells) -> NDArray[np.float64]:
    """Returns (R, P) soups with each partner."""
    return cells.per_partner(cells.ego_soups)


def per_repetition(cells: Cells) -> NDArray[np.float64]:
    """Returns the mean of each training seed, or of each episode block of the only one."""
    return cells.per_repetition(cells.ego_soups)


METRIC: Final = Metric(
    facts=MetricFacts(name="ego_soups", label="own soups", unit="soups", digits=2, tables=()),
    per_repetition=per_repetition,
    by=("overall", "layout", "partner"),
    of_partners=of_partners,
    place=40,
)
