"""The ordered curve: the mean return with the worst partner, the second worst, and so on.

Source: the thesis, 7.2, "ordered outcomes".
"""

from collections.abc import Iterable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation import statistics
from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts, Params
from overcooked_bench.evaluation.protocol import Report


def ranks(report: Report, cells: Cells) -> Iterable[Params]:
    """Lists the ranks, 1 for the worst partner."""
    return [{"rank": rank} for rank in range(1, len(cells.partners) + 1)]


def per_repetition(cells: Cells, rank: float) -> NDArray[np.float64]:
    """Returns each training seed's mean with its partner of that rank, which need not be the same for all seeds."""
    return statistics.ordered(cells.means)[:, int(rank) - 1]


METRIC: Final = Metric(
    facts=MetricFacts(name="curve", label="rank {rank:g}", tables=()),
    per_repetition=per_repetition,
    params=ranks,
    place=30,
)
