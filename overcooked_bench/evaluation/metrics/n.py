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


def of_runs(cells: Cells) -> NDArray[np.float64]:
    """Returns (S, P) N of each training seed with each partner, the mean of its sides; (0, P) without bounds."""
    return _of_means(cells, side_means(cells.returns, cells.sides))


def of_partners(cells: Cells) -> NDArray[np.float64]:
    """Returns (R, P) N with each partner, of each training seed, or of each episode block of the only one.

    A block may lack a side, as those of a single seat do. So the mean over blocks is the N of the whole run, and a
    block differs from it by what its episodes add to the means of their sides.

    Source: Cochran 1977, "Sampling Techniques", 6.4 (the linear form of a ratio).
    """
    return of_runs(cells) if len(cells.returns) > 1 else _of_means(cells, _block_means(cells))


def per_repetition(cells: Cells) -> NDArray[np.float64]:
    """Returns the N of each training seed, or of each episode block of the only one; see `of_partners`."""
    return of_partners(cells) @ cells.shares


def _of_means(cells: Cells, means: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns N from (R, P, sides) mean returns."""
    if any(label.bounds is None for label in cells.partners):
        return np.empty((0, len(cells.partners)))
    return np.asarray(np.nanmean(normalised(means, cells.partners), axis=2))


def _block_means(cells: Cells) -> NDArray[np.float64]:
    """Returns (E, P, sides) mean returns of the only run's blocks, of which the mean is that of all its episodes."""
    returns, sides = cells.returns[0], cells.sides[0]
    means = side_means(cells.returns, cells.sides)[0][:, None]
    there = sides[..., None] == np.arange(means.shape[-1])
    number = there.sum(axis=2)
    added = (returns[..., None] * there).sum(axis=2) - number * means
    return np.moveaxis(means + added / np.maximum(1e-9, number.mean(axis=1, keepdims=True)), 1, 0)


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
