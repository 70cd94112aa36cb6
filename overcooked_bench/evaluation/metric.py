"""`Metric`: a number that is computed from cells, and the registry of all of them.

A metric is one file in `evaluation/metrics/` that defines `METRIC`. Intervals, the overall mean, comparisons,
score.json and all tables follow from it.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules
from typing import Any, Final, Literal

import msgspec
import numpy as np
from numpy.typing import ArrayLike

from overcooked_bench.estimate import Estimate, t_interval
from overcooked_bench.evaluation import metrics
from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.protocol import Report

Slice = Literal["overall", "layout", "seat", "stratum", "partner", "partner and seat"]
"""What a metric is computed for: all layouts together; the partners that count on a layout, also by seat of the scored
agent or by stratum of the partner; or each partner, floors included."""

Params = Mapping[str, float]

_LAYOUT: Final[tuple[Slice, ...]] = ("layout",)


class MetricFacts(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """What has to be known to show a metric; score.json holds it, so that any version can show any metric.

    Attributes:
        name: Its name in score.json.
        label: Heading of its column; parameters in braces are filled in, as in `≥{soups:g}`.
        unit: "points", "share" (shown in percent), "soups", "partners", ...
        digits: After the decimal point.
        note: One sentence below the table; empty if the label says it all.
        interval: Whether its column shows the interval.
        tables: Where it is a column of the table of layouts: "terminal", "report", both or none.
    """

    name: str
    label: str
    unit: str = "points"
    digits: int = 1
    note: str = ""
    interval: bool = True
    tables: tuple[Literal["terminal", "report"], ...] = ("terminal", "report")

    def heading(self, params: Params) -> str:
        """Returns the label with its parameters."""
        return self.label.format(**params)


def _once(report: Report, cells: Cells) -> Iterable[Params]:
    return ({},)


@dataclass(frozen=True, kw_only=True)
class Metric:
    """A metric.

    Attributes:
        facts: How it is shown.
        per_repetition: `f(cells, **params)` returns (R,) numbers, one for each independent repetition: the S training
            seeds if there are several, else the E episode blocks of the only one, or a single number if a repetition
            does not have its own. Their mean is the metric's value. (0,) where nothing is known.
        params: `f(report, cells)` lists the parameters that it is computed with; once without any by default.
        by: What it is computed for.
        interval: `f(values, cells, **params)` for metrics whose interval is not Student's t over the repetitions.
        lowest: Intervals end here.
        highest: And here.
        place: Metrics are shown in this order.
    """

    facts: MetricFacts
    per_repetition: Callable[..., ArrayLike]
    params: Callable[[Report, Cells], Iterable[Params]] = _once
    by: Sequence[Slice] = _LAYOUT
    interval: Callable[..., Estimate] | None = None
    lowest: float = 0.0
    highest: float = np.inf
    place: int = 50

    def estimate(self, values: ArrayLike, cells: Cells | None = None, **params: Any) -> Estimate:
        """Computes the value and its interval from the repetitions.

        Args:
            values: (R,) what `per_repetition` returned.
            cells: What it was computed from; None for the mean over layouts.
            **params: The same.
        """
        if self.interval and cells is not None:
            return self.interval(np.asarray(values, np.float64), cells, **params)
        return t_interval(values, self.lowest, self.highest)


def find_metrics() -> list[Metric]:
    """Lists the metrics of the folder `evaluation/metrics`, in the order in which they are shown."""
    names = sorted(info.name for info in iter_modules(metrics.__path__))
    found = [import_module(f"{metrics.__name__}.{name}").METRIC for name in names]
    return sorted(found, key=lambda metric: (metric.place, metric.facts.name))
