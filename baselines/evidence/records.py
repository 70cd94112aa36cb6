"""What the evidence page reports, as `results/<pool>.json` holds it."""

import msgspec

from overcooked_bench.estimate import Estimate


class PartnerRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A partner of the pool on one layout.

    Attributes:
        name: In the pool.
        stratum: Its origin.
        codebase: Whose training code made it; None for this project's, or if nobody trained it.
        share: Its share of the whole score.
        convention: What it does where agents have to agree.
        floors: Points per episode, by side.
        ceilings: Points per episode, by side.
        with_itself: Points per episode with a copy of itself.
    """

    name: str
    stratum: str
    codebase: str | None
    share: float
    convention: str | None
    floors: tuple[float, ...]
    ceilings: tuple[float, ...]
    with_itself: float


class EntrantRecord(msgspec.Struct, frozen=True, kw_only=True):
    """An entrant on one layout.

    Attributes:
        reference: Where it is, such as "train-v1/coordination_ring/sp-03".
        family: Its family, which intervals draw as a whole.
        recipe: How it was made, but for its training seed.
        scores: Every score that it has, by name; those with partners that it is tied to are missing.
    """

    reference: str
    family: str
    recipe: str
    scores: dict[str, float]


class EntryRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A shipped entry on one layout: normalised scores, means over its training runs.

    Attributes:
        name: The entry.
        runs: Its training runs; 1 if it was not trained.
        pool: Its score with the pool.
        twin: Its score with the twin; None if there is no twin.
    """

    name: str
    runs: int
    pool: float
    twin: float | None


class CorrelationRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A rank correlation of two scores over entrants.

    Attributes:
        first: Name of one score.
        second: Name of the other.
        rho: With its 95 % interval over families; None if there are too few entrants.
        entrants: Number of entrants, over all layouts that it is of.
        families: Number of their families.
    """

    first: str
    second: str
    rho: Estimate | None
    entrants: int
    families: int


class LayoutRecord(msgspec.Struct, frozen=True, kw_only=True):
    """Everything about one layout.

    Attributes:
        layout: Its name.
        partners: P partners of the pool, by stratum and name.
        cross_play: (P, P) points per episode; row: the partner on seat 0, column: the one on seat 1.
        self_play: Mean of the diagonal.
        strangers: Mean over pairs of different lineages.
        ratio: The second by the first.
        effective: Effective number of partners by stratum; "all" is that of the whole pool.
        values: How many partners have each value of a convention.
        combinations: How many partners have each combination of values.
        entrants: The entrants.
        variance: Share of the variance of entrants' returns with the pool, by component; None where data show none.
        variance_points: The same in squared points; may be below zero.
        reliability: By score, what the rank correlation of two halves of the episodes says about all of them.
        correlations: Of the scores of entrants.
        entries: Shipped entries.
    """

    layout: str
    partners: tuple[PartnerRecord, ...]
    cross_play: tuple[tuple[float, ...], ...]
    self_play: Estimate
    strangers: Estimate
    ratio: Estimate | None
    effective: dict[str, float]
    values: dict[str, int]
    combinations: dict[str, int]
    entrants: tuple[EntrantRecord, ...]
    variance: dict[str, float | None]
    variance_points: dict[str, float | None]
    reliability: dict[str, float]
    correlations: tuple[CorrelationRecord, ...]
    entries: tuple[EntryRecord, ...]


class PoolRecord(msgspec.Struct, frozen=True, kw_only=True):
    """A pool that was played.

    Attributes:
        name: Its name.
        sha256: Its hash.
    """

    name: str
    sha256: str


class Evidence(msgspec.Struct, frozen=True, kw_only=True):
    """The whole content of the page.

    Attributes:
        pool: The pool that it is about.
        twin: The pool of the same configuration and another salt; None if there was none.
        entrants_of: The pools that entrants came from.
        episodes: Of every pair, from each seat.
        layouts: One for each layout.
        pooled: Correlations pooled over layouts.
    """

    pool: PoolRecord
    twin: PoolRecord | None
    entrants_of: tuple[PoolRecord, ...]
    episodes: int
    layouts: tuple[LayoutRecord, ...]
    pooled: tuple[CorrelationRecord, ...]
