"""What `results/v1-entries.json` holds: every number of the page, so that the page can be written from it alone.

Axes: S training seeds.
"""

from typing import Final

import msgspec

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.scores import Source

SCHEMA: Final = 1


class Cost(msgspec.Struct, frozen=True):
    """The price of an entry's training, all layouts and training seeds together.

    Attributes:
        core_hours: Wall-clock of its training processes, each on one core.
        joint_steps: Steps of training in which both chefs act; those of partners that were trained for it count.
        runs: Training runs, S for each layout.
        partner_runs: Further policies that were trained for these, such as the members of a population.
    """

    core_hours: float
    joint_steps: int
    runs: int
    partner_runs: int


class Seeds(msgspec.Struct, frozen=True):
    """Training seeds of one entry paired with one another on a layout.

    Attributes:
        self_play: Points per episode of each with a copy of itself.
        cross_play: Points per episode of every two of them.
        ratio: Cross-play by self-play; None if self-play brings nothing.
    """

    self_play: Estimate
    cross_play: Estimate
    ratio: Estimate | None


class LayoutRecord(msgspec.Struct, frozen=True, kw_only=True):
    """An entry on one layout.

    Attributes:
        layout: The layout.
        n: N with all partners.
        by_seed: (S,) N of each training seed.
        h50: Share of the partners with whom N is 0.5 or more.
        mean: Points per episode with all partners.
        self_play: Points per episode with a copy of itself; None if the protocol does not play it.
        seeds: Its training seeds paired with one another; None with a single one.
    """

    layout: str
    n: Estimate
    by_seed: tuple[float, ...]
    h50: Estimate
    mean: Estimate
    self_play: Estimate | None
    seeds: Seeds | None


class Ordered(msgspec.Struct, frozen=True):
    """An entry's line under the protocol `thesis`, as a part of what the best pair of self-play agents reaches.

    Attributes:
        rows: Agents that the quantile is over.
        values: The mean over layouts at each share of the partners.
        average: Their mean.
        by_layout: Layout -> the average there.
    """

    rows: int
    values: tuple[float, ...]
    average: float
    by_layout: dict[str, float]


class EntryRecord(msgspec.Struct, frozen=True, kw_only=True):
    """An entry, or the reference agent, under the protocol; numbers are means over layouts.

    Attributes:
        name: Its name.
        sha256: Hash of all its policies.
        what: How it was trained: method and configuration.
        training_seeds: S, on each layout.
        n: N; None if it does not play all layouts, as all numbers below.
        by_seed: (S,) N of each training seed.
        h50: Share of the partners with whom N is 0.5 or more.
        strata: Stratum -> N.
        home: N with the partners that it is at home with; None if there are none.
        away: N with the others; None if it is at home with none.
        worst_third: N with the worst third of the partners.
        mean: Points per episode.
        self_play: Points per episode with a copy of itself.
        criterion: Points per episode under the criterion's protocol.
        passed: Scenarios that it passed, mean over training seeds.
        attempted: Scenarios that it attempted.
        scenarios: Their share.
        thesis: Its line under the protocol `thesis`; None if it has none there.
        layouts: Each layout that it plays.
        cost: What its training cost; None if nobody recorded it.
    """

    name: str
    sha256: str
    what: str
    training_seeds: int
    n: Estimate | None
    by_seed: tuple[float, ...]
    h50: Estimate | None
    strata: dict[str, Estimate]
    home: Estimate | None
    away: Estimate | None
    worst_third: Estimate | None
    mean: Estimate | None
    self_play: Estimate | None
    criterion: Estimate | None
    passed: float
    attempted: float
    scenarios: Estimate | None
    thesis: Ordered | None
    layouts: tuple[LayoutRecord, ...]
    cost: Cost | None


class Standings(msgspec.Struct, frozen=True, kw_only=True):
    """The content of the file.

    Attributes:
        schema: Version of this form.
        protocol: What everybody was scored with.
        pool: Its partners.
        criterion: Name of the pool of the criterion column; None without one.
        thesis: The protocol `thesis`, and the pool whose self-play agents were its partners.
        positions: Shares of the partners in `Ordered.values`.
        quantile: The quantile over rows in `Ordered`.
        reference: Name of the reference agent, which is among the entries.
        entries: Everybody, the highest N first.
    """

    schema: int
    protocol: Source
    pool: Source
    criterion: str | None
    thesis: tuple[Source, Source]
    positions: tuple[float, ...]
    quantile: float
    reference: str
    entries: tuple[EntryRecord, ...]
