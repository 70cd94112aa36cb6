"""H50: the weighted share of partners with whom the agent reaches half of what can be reached, N of at least 0.5."""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.metric import Metric, MetricFacts
from overcooked_bench.evaluation.metrics.n import of_runs

HALF: Final = 0.5


def of_partners(cells: Cells) -> NDArray[np.float64]:
    """Returns (S, P), 1 for each partner that a training seed works with, else 0; (0, P) without bounds."""
    return np.asarray(of_runs(cells) >= HALF, np.float64)


def per_repetition(cells: Cells) -> NDArray[np.float64]:
    """Returns each training seed's share of partners, by their weights."""
    return of_partners(cells) @ cells.shares


METRIC: Final = Metric(
    facts=MetricFacts(
        name="h50",
        label="H50",
        unit="share",
        digits=0,
        interval=False,
        note="H50: share of the partners with whom N is 0.5 or more.",
    ),
    per_repetition=per_repetition,
    by=("overall", "layout", "seat", "side", "stratum", "home", "partner"),
    of_partners=of_partners,
    weighted=True,
    counts=True,
    highest=1.0,
    place=-19,
)
