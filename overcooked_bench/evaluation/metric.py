"""`Metric`: a number that is computed from cells, and the registry of all of them.

A metric is one file in `evaluation/metrics/` that defines `METRIC`. Intervals, the overall mean, comparisons,
score.json and all tables follow from it.
"""

import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from importlib import import_module
from pkgutil import iter_modules
from typing import Annotated, Final, Literal, NamedTuple

import msgspec
import numpy as np
from msgspec import Meta
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation import metrics
from overcooked_bench.evaluation.cells import Cells
from overcooked_bench.evaluation.estimators import Figure, Group, count_variance, over_partners, over_repetitions
from overcooked_bench.evaluation.protocol import Report

Slice = Literal["overall", "layout", "seat", "side", "stratum", "home", "partner", "partner and seat"]
"""What a metric is computed for: all layouts together; the partners that count on a layout, also by seat of the scored
agent, by side of the floor that it starts on, by stratum of the partner, or at home and away; or each partner, floors
included. What is computed for all layouts together is so for each stratum, and at home and away, too."""

Params = Mapping[str, float]

_LAYOUT: Final[tuple[Slice, ...]] = ("layout",)


class MetricFacts(msgspec.Struct, frozen=True, kw_only=True, omit_defaults=True):
    """What has to be known to show a metric; score.json holds it, so that any version can show any metric.

    Attributes:
        name: Its name in score.json.
        label: Heading of its column; parameters in braces are filled in, as in `≥{soups:g}`; `{chef:own|partner's}`
            picks one of the words by number. Nothing else is understood in braces.
        unit: "points", "share" (shown in percent), "soups", "partners", ...
        digits: After the decimal point.
        note: One sentence below the table; empty if the label says it all.
        interval: Whether its column shows the interval.
        tables: Where it is a column of the table of layouts: "terminal", "report", both or none.
    """

    name: str
    label: str
    unit: str = "points"
    digits: Annotated[int, Meta(ge=0, le=9)] = 1
    note: str = ""
    interval: bool = True
    tables: tuple[Literal["terminal", "report"], ...] = ("terminal", "report")

    def heading(self, params: Params) -> str:
        """Returns the label with its parameters.

        Raises:
            ValueError: The label has a parameter that is not given, or a number of a word that it does not list.
        """

        def filled(field: re.Match[str]) -> str:
            name, _, spec = field[1].partition(":")
            value, words = params.get(name), spec.split("|")
            if value is None or (len(words) > 1 and value not in range(len(words))):
                raise ValueError(f"the label {self.label!r} cannot be filled in with {dict(params)}")
            return words[int(value)] if len(words) > 1 else f"{value:g}"

        return re.sub(r"\{([^{}]*)\}", filled, self.label)


def _once(report: Report, cells: Cells) -> Iterable[Params]:
    return ({},)


class Figured(NamedTuple):
    """A number with what is known about its error.

    Attributes:
        estimate: The number with its interval.
        error: Its standard error; None if the data give none.
    """

    estimate: Estimate
    error: float | None


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
        of_partners: `f(cells, **params)` returns (R, P) numbers that `per_repetition` is the mean over partners of, if
            it is one; the interval of a single training run is then over partners.
        weighted: Whether partners have their shares in that mean, or all the same.
        counts: Whether the numbers of partners are 0 or 1.
        rounding: `f(cells, **params)` returns the variance of a block with one partner that whole soups alone make.
        interval: `f(values, cells, **params)` for metrics whose interval of plain estimators is not Student's t over
            the repetitions.
        lowest: Intervals end here.
        highest: And here.
        place: Metrics are shown in this order.
    """

    facts: MetricFacts
    per_repetition: Callable[..., ArrayLike]
    params: Callable[[Report, Cells], Iterable[Params]] = _once
    by: Sequence[Slice] = _LAYOUT
    of_partners: Callable[..., ArrayLike] | None = None
    weighted: bool = False
    counts: bool = False
    rounding: Callable[..., float] | None = None
    interval: Callable[..., Estimate] | None = None
    lowest: float = 0.0
    highest: float = np.inf
    place: int = 50

    def estimate(self, values: ArrayLike, cells: Sequence[Cells], report: Report, params: Params) -> Figured:
        """Computes the value, its interval and its standard error.

        Args:
            values: (R,) what `per_repetition` returned, for several layouts their mean.
            cells: What it was computed from, one for each layout.
            report: Says which estimators are wanted.
            params: The same.
        """
        if report.estimators == "repaired":
            figure = self._repaired(np.asarray(values, np.float64), cells, params)
            return Figured(figure.estimate(self.lowest, self.highest), figure.error)
        figure = over_repetitions(values)
        if self.interval and len(cells) == 1:
            return Figured(self.interval(np.asarray(values, np.float64), cells[0], **params), figure.error)
        return Figured(figure.estimate(self.lowest, self.highest), figure.error)

    def _repaired(self, values: NDArray[np.float64], cells: Sequence[Cells], params: Params) -> Figure:
        if self.of_partners is None:
            return over_repetitions(values)
        found = [np.asarray(self.of_partners(one, **params), np.float64) for one in cells]
        shares = [(one.shares if self.weighted else _equal(one)) / len(cells) for one in cells]
        least = sum(map(count_variance, found, shares)) if self.counts else 0.0
        if len(cells[0].returns) > 1:
            return over_repetitions(values, least)
        if max(len(one.partners) for one in cells) == 1:
            added = sum(self.rounding(one, **params) for one in cells) / len(cells) ** 2 if self.rounding else 0.0
            return over_repetitions(values, least, added)
        groups = [
            Group(numbers.mean(axis=0), share, [label.stratum for label in one.partners])
            for one, numbers, share in zip(cells, found, shares, strict=True)
        ]
        return over_partners(groups, least)


def _equal(cells: Cells) -> NDArray[np.float64]:
    return np.full(len(cells.partners), 1 / len(cells.partners))


def chosen_metrics(report: Report) -> list[Metric]:
    """Lists the metrics of a report, and the mean return in any case, in the order in which they are shown."""
    return [metric for metric in find_metrics() if not report.metrics or metric.facts.name in ("mean", *report.metrics)]


def find_metrics() -> list[Metric]:
    """Lists the metrics of the folder `evaluation/metrics`, in the order in which they are shown."""
    names = sorted(info.name for info in iter_modules(metrics.__path__))
    found = [import_module(f"{metrics.__name__}.{name}").METRIC for name in names]
    return sorted(found, key=lambda metric: (metric.place, metric.facts.name))
