"""The tables of the page, all from the records."""

from collections.abc import Callable, Sequence
from typing import Final

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.shown.card import HEADS, STRATA
from overcooked_bench.evaluation.shown.comparison import p_text
from overcooked_bench.evaluation.shown.tables import NONE, count_text
from overcooked_bench.rendering.table import Cell, Column, Table

from .records import EntryRecord, LayoutRecord, Seeds, Standings
from .separated import Pair, letters

MEAN: Final = "mean"

Rows = list[list[Cell]]


def headline_table(found: Standings, compared: Sequence[Pair]) -> Table:
    """Lays out what every entry is judged by, and the columns that never rank; the reference agent is below."""
    groups = letters(found.entries, compared)

    def cells(one: EntryRecord) -> list[Cell]:
        return [
            *(one.name, str(one.training_seeds), number(one.n, 2), groups.get(one.name, NONE), share(one.h50)),
            *(number(one.mean, 1), number(one.self_play, 1), number(one.criterion, 1)),
            f"{count_text(one.passed)} of {count_text(one.attempted)}",
            share(one.scenarios),
        ]

    heads: list[str | Column] = [
        "entry",
        "seeds",
        "N [95 %]",
        Column("group", left=True),
        "H50",
        "points",
        "with itself",
    ]
    return _with_reference(found, [*heads, found.criterion or "criterion", "scenarios", "passed"], cells)


def strata_table(found: Standings) -> Table:
    """Lays out N by the origin of the partners, at home, away, and with the worst third."""
    strata = strata_of(found)

    def cells(one: EntryRecord) -> list[Cell]:
        numbers = [*(one.strata.get(name) for name in strata), one.home, one.away, one.worst_third]
        return [one.name, *(number(value, 2) for value in numbers)]

    heads = [heading(name) for name in strata]
    return _with_reference(found, ["N with", *heads, "at home", "away", "worst third"], cells)


def layouts_table(found: Standings, heading: str, cell: Callable[[LayoutRecord], Cell]) -> Table:
    """Lays out one number of every entry on every layout.

    Args:
        found: The records.
        heading: What the number is.
        cell: Writes it.
    """
    layouts = layouts_of(found)

    def cells(one: EntryRecord) -> list[Cell]:
        known = {layout.layout: layout for layout in one.layouts}
        return [one.name, *(cell(known[name]) if name in known else NONE for name in layouts)]

    return _with_reference(found, [heading, *layouts], cells)


def seeds_range_table(found: Standings) -> Table:
    """Lays out the lowest and the highest training seed, of the mean and of each layout."""
    layouts = layouts_of(found)

    def cells(one: EntryRecord) -> list[Cell]:
        known = {layout.layout: layout.by_seed for layout in one.layouts}
        return [one.name, _ends(one.by_seed), *(_ends(known.get(name, ())) for name in layouts)]

    rows = [cells(one) for one in found.entries if one.training_seeds > 1]
    return Table(["N, lowest to highest seed", "mean of layouts", *layouts], rows)


def pairs_table(compared: Sequence[Pair]) -> Table:
    """Lays out every two methods, those first that are surest to differ."""
    rows: Rows = [
        [
            *(pair.first, pair.second, str(pair.seeds), number(pair.difference, 2), f"{100 * pair.better:.0f} %"),
            *(p_text(pair.p), p_text(pair.adjusted), "separated" if pair.separated else NONE),
        ]
        for pair in sorted(compared, key=lambda pair: (pair.adjusted, -pair.difference.value))
    ]
    heads: list[str | Column] = [
        Column("higher", left=True),
        Column("lower", left=True),
        "seeds",
        "N: difference [95 %]",
        "better",
        "p",
    ]
    return Table([*heads, "Holm", Column("", left=True)], rows)


def thesis_table(found: Standings) -> Table:
    """Lays out the ordered curves of the entries that have one, at shares of the partners, and by layout."""
    known = [one for one in found.entries if one.thesis]
    layouts = list(dict.fromkeys(name for one in known if one.thesis for name in one.thesis.by_layout))

    def cells(one: EntryRecord) -> list[Cell]:
        line = one.thesis
        if line is None:
            return [one.name, NONE]
        by_layout = (f"{line.by_layout[name]:.3f}" if name in line.by_layout else NONE for name in layouts)
        values = (f"{value:.3f}" for value in line.values)
        return [one.name, str(line.rows), *values, f"{line.average:.3f}", *by_layout]

    heads = ["entry", "rows", *(f"{100 * share:g} %" for share in found.positions), "average"]
    return _with_reference(found, [*heads, *layouts], cells)


def cross_play_table(found: Standings) -> Table:
    """Lays out what is left of self-play where an entry's training seeds meet one another, by layout."""

    def cell(one: LayoutRecord) -> Cell:
        seeds = one.seeds
        return NONE if seeds is None else f"{_points(seeds.self_play)} → {_points(seeds.cross_play)} ({_ratio(seeds)})"

    layouts = layouts_of(found)
    rows: Rows = []
    for one in found.entries:
        if any(layout.seeds for layout in one.layouts):
            known = {layout.layout: layout for layout in one.layouts}
            rows.append([one.name, *(cell(known[name]) if name in known else NONE for name in layouts)])
    return Table(["self-play → cross-play (ratio)", *layouts], rows)


def costs_table(found: Standings) -> Table:
    """Lays out what the training of each entry cost."""
    rows: Rows = []
    for one in found.entries:
        if one.name == found.reference:
            continue
        cost = one.cost
        numbers = ["not recorded"]
        if cost is not None:
            numbers = [f"{cost.core_hours:.1f}", f"{cost.joint_steps / 1e6:.0f} M", str(cost.runs)]
            numbers.append(str(cost.partner_runs))
        rows.append([one.name, one.what, *numbers])
    heads: list[str | Column] = [Column("trained by", left=True), "core-hours", "joint steps", "runs", "partner runs"]
    return Table(["entry", *heads], rows)


def strata_of(found: Standings) -> list[str]:
    """Lists the strata of all entries, the known ones first."""
    there = dict.fromkeys(name for one in found.entries for name in one.strata)
    return [*(name for name in STRATA if name in there), *(name for name in there if name not in STRATA)]


def heading(stratum: str) -> str:
    """Returns the heading of a stratum's column, in one line."""
    return HEADS.get(stratum, stratum).replace("\n", " ")


def layouts_of(found: Standings) -> list[str]:
    """Lists the layouts of all entries."""
    most = max(found.entries, key=lambda one: len(one.layouts))
    return [layout.layout for layout in most.layouts]


def number(estimate: Estimate | None, digits: int) -> str:
    """Writes a number with its interval."""
    return NONE if estimate is None else estimate.text(digits)


def share(estimate: Estimate | None) -> str:
    """Writes a share in percent with its interval."""
    if estimate is None:
        return NONE
    value, low, high = (None if end is None else 100 * end for end in estimate)
    assert value is not None
    return f"{value:.0f} %" + (f" [{low:.0f}, {high:.0f}]" if low is not None and high is not None else "")


def _with_reference(
    found: Standings, heads: Sequence[str | Column], cells: Callable[[EntryRecord], list[Cell]]
) -> Table:
    """Lays out a row per entry, and the reference agent below a line."""
    rows = [cells(one) for one in found.entries if one.name != found.reference]
    return Table(heads, rows, [cells(one) for one in found.entries if one.name == found.reference])


def _ends(values: Sequence[float]) -> str:
    return f"{min(values):.2f} to {max(values):.2f}" if values else NONE


def _points(estimate: Estimate) -> str:
    return f"{estimate.value:.0f}"


def _ratio(seeds: Seeds) -> str:
    return NONE if seeds.ratio is None else seeds.ratio.text(2)
