"""The tables of the evidence page."""

from collections.abc import Sequence
from typing import Final

import numpy as np

from overcooked_bench.estimate import Estimate
from overcooked_bench.rendering.table import Column, Table

from .components import COMPONENTS
from .records import CorrelationRecord, Evidence, LayoutRecord
from .scores import MEAN, PLAIN, SELF_PLAY, WHOLE
from .study import ALL
from .validity import CLONES, HEADLINE, PEOPLE, PREDICTORS, SAME, pairs

_NONE: Final = "-"
_PREDICTORS: Final = {
    HEADLINE: "N without human",
    WHOLE: "N",
    PLAIN: "plain mean, without human",
    MEAN.format("dev-v1"): "mean with dev-v1",
    MEAN.format("dev-v0"): "mean with dev-v0",
    SELF_PLAY: "self-play return",
    CLONES: "mean with human-train: the ceiling",
}


def strata_of(found: Evidence) -> list[str]:
    """Lists the strata of the pool, in the order of its partners."""
    return list(dict.fromkeys(partner.stratum for layout in found.layouts for partner in layout.partners))


def pool_table(found: Evidence) -> Table:
    """Sums up the partners of each layout: with themselves, with one another, how many they are, and their bounds."""
    strata = strata_of(found)
    rows = []
    for layout in found.layouts:
        counts = [sum(partner.stratum == stratum for partner in layout.partners) for stratum in strata]
        numbers = [
            f"{layout.effective[name]:.1f} of {n}" if n else _NONE for name, n in zip(strata, counts, strict=True)
        ]
        rows.append(
            [
                layout.layout,
                layout.self_play.text(0),
                layout.strangers.text(0),
                layout.ratio.text(2) if layout.ratio else _NONE,
                f"{layout.effective[ALL]:.1f} of {sum(counts)}",
                *numbers,
            ]
        )
    return Table(["layout", "self-play", "cross-play", "ratio", "effective number", *strata], rows)


def bounds_table(found: Evidence) -> Table:
    """Shows the floors and ceilings of each layout: lowest, median and highest over partners and sides."""
    rows = []
    for layout in found.layouts:
        floors = np.array([floor for partner in layout.partners for floor in partner.floors])
        ceilings = np.array([ceiling for partner in layout.partners for ceiling in partner.ceilings])
        sides = len(layout.partners[0].floors)
        rows.append([layout.layout, str(sides), *map(_spread, (floors, ceilings, ceilings - floors))])
    return Table(["layout", "sides", "floor", "ceiling", "ceiling - floor"], rows)


def conventions_table(found: Evidence) -> Table:
    """Counts the values of each axis of convention, and the share of the most frequent combination."""
    rows = []
    for layout in found.layouts:
        values = ", ".join(f"{value} ({count})" for value, count in layout.values.items()) or "not in the manifest"
        top = next(iter(layout.combinations.items()), None)
        most = f"{top[0]}: {top[1]} of {sum(layout.combinations.values())}" if top else _NONE
        rows.append([layout.layout, values, str(len(layout.combinations)), most])
    first, last = Column("values (partners)", left=True), Column("most frequent combination", left=True)
    return Table(["layout", first, "combinations", last], rows)


def variance_table(found: Evidence) -> Table:
    """Shows each component's share of the variance of entrants' returns with the pool, in percent."""
    rows = [
        [layout.layout, *(_percent(layout.variance.get(name)) for name in COMPONENTS), _total(layout)]
        for layout in found.layouts
    ]
    return Table(["layout", *COMPONENTS, "total, points"], rows)


def validity_table(found: Evidence) -> Table:
    """Shows the correlations between scores: the twin, strata left out, and proxies of people."""
    names = {pair: name for pair, name in zip(pairs(strata_of(found)), _letters(strata_of(found)), strict=True)}
    cells = {pair: [correlation_of(one, *pair) for one in _columns(found)] for pair in names}
    present = [pair for pair in names if any(cells[pair])]
    rows = [[names[pair], *map(_rho, cells[pair])] for pair in present]
    firsts = {names[pair][:3]: pair for pair in reversed(present)}  # all pairs of (b) have the same entrants
    foot = [[f"entrants of {letter}, of families", *map(_entrants, cells[firsts[letter]])] for letter in sorted(firsts)]
    return Table(["Spearman", *_heads(found)], rows, foot)


def predictors_table(found: Evidence) -> Table:
    """Compares predictors of the mean with proxies of people, all over the same entrants."""
    columns = _columns(found)
    rows, numbers = [], [_NONE] * len(columns)
    for name in PREDICTORS:
        cells = [correlation_of(one, SAME + name, PEOPLE) for one in columns]
        if any(cells):
            rows.append([_PREDICTORS[name], *map(_rho, cells)])
            numbers = [*map(_entrants, cells)]
    return Table(["predictor", *_heads(found)], rows, [["entrants, of families", *numbers]])


def reliability_table(found: Evidence) -> Table:
    """Shows how far the ranks of entrants would be repeated with other episodes."""
    names = list(dict.fromkeys(name for layout in found.layouts for name in layout.reliability))
    rows = [
        [
            name,
            *(f"{layout.reliability[name]:.2f}" if name in layout.reliability else _NONE for layout in found.layouts),
        ]
        for name in names
    ]
    return Table(["score", *(layout.layout for layout in found.layouts)], rows)


def entries_table(found: Evidence) -> Table:
    """Shows N of each entry, with the pool and with the twin."""
    names = list(dict.fromkeys(entry.name for layout in found.layouts for entry in layout.entries))
    rows = []
    for name in names:
        by_layout = [next((one for one in layout.entries if one.name == name), None) for layout in found.layouts]
        runs = max(one.runs for one in by_layout if one)
        for which, part in (("pool", found.pool), ("twin", found.twin)):
            if part is None:
                continue
            values = [getattr(one, which) if one else None for one in by_layout]
            known = [value for value in values if value is not None]
            mean = f"{np.mean(known):.2f}" if len(known) == len(values) else _NONE
            cells = [_NONE if value is None else f"{value:.2f}" for value in values]
            rows.append([*((name, str(runs)) if which == "pool" else ("", "")), part.name, *cells, mean])
    layouts = [layout.layout for layout in found.layouts]
    return Table([Column("entry", left=True), "runs", Column("with", left=True), *layouts, "mean"], rows)


def _letters(strata: Sequence[str]) -> list[str]:
    left_out = [f"(b) {stratum} left out: the others against it" for stratum in strata]
    return ["(a) N against N with the twin", *left_out, "(c) N without human against human-test"]


def _columns(found: Evidence) -> list[Sequence[CorrelationRecord]]:
    return [*(layout.correlations for layout in found.layouts), found.pooled]


def _heads(found: Evidence) -> list[str]:
    return [*(layout.layout for layout in found.layouts), "pooled"]


def correlation_of(records: Sequence[CorrelationRecord], first: str, second: str) -> CorrelationRecord | None:
    """Returns the record of two scores, None if there is none."""
    return next((one for one in records if (one.first, one.second) == (first, second)), None)


def _rho(record: CorrelationRecord | None) -> str:
    return _NONE if record is None or record.rho is None else record.rho.text(2)


def _entrants(record: CorrelationRecord | None) -> str:
    return _NONE if record is None else f"{record.entrants} of {record.families}"


def _percent(value: float | None) -> str:
    return _NONE if value is None else f"{100 * value:.0f} %"


def _total(layout: LayoutRecord) -> str:
    return f"{sum(max(0.0, value or 0.0) for value in layout.variance_points.values()) ** 0.5:.0f}"


def _spread(values: "np.ndarray[tuple[int], np.dtype[np.float64]]") -> str:
    if not len(values):
        return _NONE
    return f"{np.min(values):.0f} / {np.median(values):.0f} / {np.max(values):.0f}"


def estimate_of(records: Sequence[CorrelationRecord], first: str, second: str) -> Estimate | None:
    """Returns a correlation with its interval; None if it could not be computed."""
    record = correlation_of(records, first, second)
    return record.rho if record else None
