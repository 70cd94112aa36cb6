"""OvercookedV2's claim put to the test: does state augmentation close the gap between self-play and cross-play?

Gessler et al. 2025, "OvercookedV2: Rethinking Overcooked for Zero-Shot Coordination", say that self-play agents fail
with one another because they meet states that they were never in, and that random objects in the start states mend it.
That can be read in two ways: such agents cooperate with *one another*, independently trained by the same method; or
they cooperate with *strangers*. Both are measured here.
"""

from math import hypot
from typing import Final, Literal, NamedTuple

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.shown.comparison import p_text
from overcooked_bench.evaluation.shown.tables import NONE
from overcooked_bench.rendering.table import Cell, Table

from .records import EntryRecord, LayoutRecord, Standings
from .separated import difference
from .tables import number

AUGMENTED: Final = "state-augmented"
PLAIN: Final = "self-play"
"""Names of the two entries."""
ALL: Final = "mean of layouts"


class Claim(NamedTuple):
    """The claim on one layout, or over all; differences are state-augmented minus plain self-play.

    Attributes:
        layout: The layout, or `ALL`.
        self_play: Points per episode of agents with themselves.
        cross_play: Points per episode of training seeds with one another.
        gap: Self-play minus cross-play: what is lost where partners were trained independently.
        n: N with the pool.
        p: Of the difference in N.
    """

    layout: str
    self_play: Estimate
    cross_play: Estimate
    gap: Estimate
    n: Estimate
    p: float


def claims(found: Standings) -> list[Claim]:
    """Computes the differences on each layout that both entries play, and over all; none without both entries."""
    known = {one.name: one for one in found.entries}
    if AUGMENTED not in known or PLAIN not in known:
        return []
    mine, plain = known[AUGMENTED], known[PLAIN]
    theirs = {one.layout: one for one in plain.layouts}
    pairs = [(one, theirs[one.layout]) for one in mine.layouts if one.layout in theirs]
    rows = [claim for pair in pairs if (claim := _claim(mine, plain, pair)) is not None]
    whole = difference(mine, plain)
    if len(rows) < 2 or whole is None:
        return rows
    means = [mean([getattr(row, name) for row in rows]) for name in ("self_play", "cross_play", "gap")]
    return [*rows, Claim(ALL, means[0], means[1], means[2], *whole)]


def minus(one: Estimate, other: Estimate) -> Estimate:
    """Returns the difference of two independent numbers, with the root of the sum of squares of their half-widths.

    With intervals by Student's t this is a little wider than need be: the difference has more degrees of freedom.
    """
    value = one.value - other.value
    if one.high is None or other.high is None:
        return Estimate(value)
    half = hypot(one.high - one.value, other.high - other.value)  # a lower end may be clipped at 0
    return Estimate(value, value - half, value + half)


def mean(estimates: list[Estimate]) -> Estimate:
    """Returns the mean of independent numbers; see `minus` for its interval."""
    value = sum(one.value for one in estimates) / len(estimates)
    halves = [one.high - one.value for one in estimates if one.high is not None]
    if len(halves) < len(estimates):
        return Estimate(value)
    half = hypot(*halves) / len(estimates)
    return Estimate(value, value - half, value + half)


def claims_table(rows: list[Claim]) -> Table:
    """Lays out the differences."""

    def cells(one: Claim) -> list[Cell]:
        points = [number(value, 1) for value in (one.self_play, one.cross_play, one.gap)]
        return [one.layout, *points, number(one.n, 2), p_text(one.p)]

    heads = [f"{AUGMENTED} - {PLAIN}", "with itself", "seeds with one another", "gap", "N with the pool", "p"]
    body, foot = ([one for one in rows if (one.layout == ALL) is last] for last in (False, True))
    return Table(heads, [cells(one) for one in body], [cells(one) for one in foot])


def readings(rows: list[Claim]) -> list[str]:
    """Says of both readings whether they hold here, from the last row: an interval that excludes 0 decides."""
    last = rows[-1]
    return [
        f"The seeds of one method cooperate with one another: {_verdict(last.cross_play)}. State augmentation changes "
        f"what they reach by {number(last.cross_play, 1)} points, and the gap to self-play by {number(last.gap, 1)}.",
        f"The agents cooperate with strangers: {_verdict(last.n)}. It changes N with the pool by {number(last.n, 2)} "
        f"(p {p_text(last.p) or NONE}).",
    ]


def _verdict(found: Estimate) -> Literal["holds here", "the opposite holds here", "undecided here"]:
    if found.interval is None or found.interval[0] <= 0 <= found.interval[1]:
        return "undecided here"
    return "holds here" if found.value > 0 else "the opposite holds here"


def _claim(mine: EntryRecord, plain: EntryRecord, pair: tuple[LayoutRecord, LayoutRecord]) -> Claim | None:
    here, there = pair
    n = difference(mine, plain, here.layout)
    if here.seeds is None or there.seeds is None or n is None:
        return None
    own = minus(here.seeds.self_play, there.seeds.self_play)
    crossed = minus(here.seeds.cross_play, there.seeds.cross_play)
    gaps = [minus(one.seeds.self_play, one.seeds.cross_play) for one in pair if one.seeds]
    return Claim(here.layout, own, crossed, minus(*gaps), *n)
