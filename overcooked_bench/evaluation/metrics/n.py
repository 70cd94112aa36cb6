"""N: the mean return on a scale from 0, the better of `stay` and `random`, to 1, the best known responder.

Per partner and side (mean - floor) / (ceiling - floor), never clipped; partners by the pool's weights, strata equally.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.estimators import rounding_variance
from overcooked_bench.evaluation.metric import Metric, MetricFacts
from overcooked_bench.evaluation.pools.normalised import normalised, side_means


def of_partners(cells: Cells) -> NDArray[np.float64]:
    """Returns (R, P) N with each partner, the mean of its sides; (0, P) if the pool has no bounds."""
    if any(label.bounds is None for label in cells.partners):
        return np.empty((0, len(cells.partners)))
    returns, sides = cells.returns, cells.sides
    if len(returns) == 1:  # episode blocks are the repetitions
        returns, sides = (np.moveaxis(array[0], 1, 0)[:, :, None] for array in (returns, sides))
    values = normalised(side_means(returns, sides), cells.partners)
    return np.asarray(np.nanmean(values, axis=2))


def per_repetition(cells: Cells) -> NDArray[np.float64]:
    """Returns the N of each training seed, or of each episode block of the only one."""
    return of_partners(cells) @ cells.shares


def rounding(cells: Cells) -> float:
    """Returns the variance of a block's N with the only partner that whole soups make."""
    (label,) = cells.partners
    there = np.unique(cells.sides)
    ranges = [bound.ceiling - bound.floor for bound in label.bounds or () if bound.side in there]
    points = rounding_variance(cells.soup_points, len(cells.seats))
    return points * float(np.mean([1 / (one * one) for one in ranges]))


METRIC: Final = Metric(
    facts=MetricFacts(
        name="n",
        label="N [95 %]",
        unit="",
        digits=2,
        note="N: 0 as the better of stay and random, 1 as the best known responder to each partner.",
    ),
    per_repetition=per_repetition,
    by=("overall", "layout", "seat", "side", "stratum", "home", "partner"),
    of_partners=of_partners,
    weighted=True,
    rounding=rounding,
    lowest=-np.inf,
    place=-20,
)
