"""`Scores`: what score.json says, and how it follows from the stored episodes.

Axes: S training seeds, P partners, E episode indices, K seats of the scored agent.
"""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation import statistics
from overcooked_bench.evaluation.protocol import Protocol
from overcooked_bench.evaluation.store import Store
from overcooked_bench.kitchen.layout import DEFAULT_SOUP_REWARD

SCHEMA: Final = 1
FLOOR: Final = "floor"


class ScoresError(ValueError):
    """A score.json cannot be read; the message names the file and the entry."""


class Estimate(msgspec.Struct, frozen=True):
    """A number with its 95 % interval; `Scores.interval` says what the interval is about.

    Attributes:
        value: The estimate.
        low: Lower end, null where the data give none.
        high: Upper end, null where the data give none.
    """

    value: float
    low: float | None
    high: float | None


class Cell(msgspec.Struct, frozen=True):
    """The scored agent with one partner on one layout.

    Attributes:
        partner: The partner's name.
        kind: "trained", "scripted" or "floor".
        sha256: Hash of what the partner is.
        mean: Points an episode, averaged over seats.
        seats: The same with the scored agent on each of the protocol's seats.
        ego_soups: Soups an episode that the scored agent delivered.
        partner_soups: Soups an episode that the partner delivered.
        is_ego: Whether the partner is the scored agent itself.
    """

    partner: str
    kind: str
    sha256: str
    mean: Estimate
    seats: tuple[Estimate, ...]
    ego_soups: float
    partner_soups: float
    is_ego: bool


class ThresholdScore(msgspec.Struct, frozen=True):
    """How many partners reach a number of soups.

    Attributes:
        soups: The level.
        count: Partners with a mean of at least that, of `LayoutScore.partners`.
        share: The same as a share.
        undecided: Partners whose mean lies within two standard errors of the level; they count where their mean is.
    """

    soups: float
    count: Estimate
    share: float
    undecided: int


class CurvePoint(msgspec.Struct, frozen=True):
    """One point of the ordered curve.

    Attributes:
        rank: 1 for the worst partner, whoever that is for each training seed.
        mean: Points an episode; the interval is pointwise, and there is none for a single training run.
        low_quantile: Type-7 0.15-quantile over training seeds; null for a single one.
    """

    rank: int
    mean: Estimate
    low_quantile: float | None


class LayoutScore(msgspec.Struct, frozen=True):
    """The scores on one layout.

    Attributes:
        layout: Its name.
        adapted: Whether the agent was given the mirror image, because it knows the layout only that way round.
        partners: Partners that count.
        mean: Points an episode, averaged over partners and seats.
        seats: The same with the scored agent on each of the protocol's seats.
        thresholds: One for each of the protocol's levels.
        tail_quantile: 0.15-quantile over partners, averaged over training seeds, points.
        tail_mean: Mean over the worst 15 % of the partners, averaged over training seeds, points.
        low_quantile: What is known about the 0.15-quantile over training seeds, in words; null for a single one.
        curve: Partners in ascending order.
        cells: The partners that count, in the order of their means; equals by name.
        floors: The partners that do not, by name.
    """

    layout: str
    adapted: bool
    partners: int
    mean: Estimate
    seats: tuple[Estimate, ...]
    thresholds: tuple[ThresholdScore, ...]
    tail_quantile: Estimate
    tail_mean: Estimate
    low_quantile: str | None
    curve: tuple[CurvePoint, ...]
    cells: tuple[Cell, ...]
    floors: tuple[Cell, ...]

    @property
    def worst(self) -> Cell:
        """The partner with the lowest mean."""
        return self.cells[0]

    @property
    def best(self) -> Cell:
        """The partner with the highest mean."""
        return self.cells[-1]


class Source(msgspec.Struct, frozen=True):
    """Something that took part.

    Attributes:
        name: What it is called.
        sha256: Hash of what it is.
    """

    name: str
    sha256: str


class Scores(msgspec.Struct, frozen=True):
    """A score.json.

    Attributes:
        schema: Version of this form.
        protocol: What was played.
        settings: The protocol in full.
        agent: Who was scored.
        pool: The trained partners; null where there were none.
        seed: 0 for scores that are to be compared.
        training_seeds: Independent training runs of the agent, S.
        interval: What the intervals are about, and what not.
        overall: Equal-weight mean over the attempted layouts, points an episode; null where none was attempted.
        layouts: In the protocol's order.
        not_attempted: Layouts that the agent says it cannot play.
        run: Times, versions and everything else that may differ between two runs of the same score.
    """

    schema: int
    protocol: Source
    settings: Protocol
    agent: Source
    pool: Source | None
    seed: int
    training_seeds: int
    interval: str
    overall: Estimate | None
    layouts: tuple[LayoutScore, ...]
    not_attempted: tuple[str, ...]
    run: dict[str, Any]

    def write(self, file: str | Path) -> None:
        """Writes score.json, all or nothing."""
        data = msgspec.json.format(msgspec.json.encode(self), indent=2) + b"\n"
        unfinished = Path(file).with_name(Path(file).name + ".part")
        unfinished.write_bytes(data)
        os.replace(unfinished, file)


def read_scores(file: str | Path) -> Scores:
    """Reads a score.json.

    Raises:
        ScoresError: It is missing, not a score.json, or of another schema.
    """
    try:
        scores = msgspec.json.decode(Path(file).read_bytes(), type=Scores)
    except (OSError, msgspec.DecodeError, ValueError) as error:
        raise ScoresError(f"{file}: not a score.json of this version ({error})") from error
    if scores.schema != SCHEMA:
        raise ScoresError(f"{file}: its schema is {scores.schema}; this version reads {SCHEMA}")
    return scores


def compute_layouts(
    store: Store, protocol: Protocol, layouts: Sequence[str], training_seeds: int, agent_sha256: str
) -> tuple[tuple[LayoutScore, ...], Estimate | None]:
    """Computes the scores of layouts whose blocks are all in the store.

    Args:
        store: Where the episodes are.
        protocol: What was played.
        layouts: The attempted ones.
        training_seeds: S; all of them count.
        agent_sha256: Hash of the scored agent, to recognise it among its partners.

    Returns:
        One score for each layout, and the equal-weight mean over them.
    """
    rows: dict[str, dict[tuple[str, str, str], dict[tuple[int, int, int], tuple[float, int, int]]]] = {}
    for layout, run, episode, partner, seat, sha256, kind, reward, _, _, ego_soups, partner_soups in store.returns():
        who = rows.setdefault(layout, {}).setdefault((partner, kind, sha256), {})
        who[run, episode, seat] = reward, ego_soups, partner_soups
    adapted, scores, strata = store.adapted(), [], []
    shape = training_seeds, protocol.episodes, len(protocol.seats)
    for layout in layouts:
        tables = {who: _table(games, shape, protocol.seats) for who, games in sorted(rows[layout].items())}
        counting = {who: table for who, table in tables.items() if who[1] != FLOOR}
        cells = [_cell(who, table, agent_sha256) for who, table in tables.items()]
        returns = np.stack([table[..., 0] for table in counting.values()], axis=1)  # (S, P, E, K)
        scores.append(_layout_score(layout, layout in adapted, returns, cells, protocol))
        strata.append(_repetitions(returns))
    overall = Estimate(*statistics.combined(strata)) if strata else None
    return tuple(scores), overall


def describe_interval(training_seeds: int, episodes: int) -> str:
    """Says what the intervals are about."""
    if training_seeds > 1:
        return f"95 % t intervals over {training_seeds} training seeds, for this pool of partners."
    if episodes > 1:
        return (
            f"95 % t intervals over {episodes} episode blocks of one training run, for this pool of partners; "
            "they say nothing about retraining."
        )
    return "No intervals: a single episode block of one training run."


def _table(
    games: dict[tuple[int, int, int], tuple[float, int, int]], shape: tuple[int, int, int], seats: Sequence[int]
) -> NDArray[np.float64]:
    """Lays one partner's games out as (S, E, K, 3): points, own soups, the partner's soups."""
    runs, episodes, _ = shape
    return np.array([[[games[s, e, k] for k in seats] for e in range(episodes)] for s in range(runs)], np.float64)


def _repetitions(returns: NDArray[np.float64]) -> NDArray[np.float64]:
    """Gives what an interval is made of, from (S, P, E, K): the S training runs, or the E blocks of the only one."""
    return returns.mean(axis=(1, 2, 3)) if len(returns) > 1 else returns.mean(axis=(0, 1, 3))


def _estimate(returns: NDArray[np.float64]) -> Estimate:
    return Estimate(*statistics.t_interval(_repetitions(returns), lowest=0))


def _seats(returns: NDArray[np.float64]) -> tuple[Estimate, ...]:
    return tuple(_estimate(returns[..., k : k + 1]) for k in range(returns.shape[-1]))


def _cell(who: tuple[str, str, str], table: NDArray[np.float64], agent_sha256: str) -> Cell:
    name, kind, sha256 = who
    returns, (_, mine, theirs) = table[:, None, :, :, 0], table.mean(axis=(0, 1, 2)).tolist()
    return Cell(name, kind, sha256, _estimate(returns), _seats(returns), mine, theirs, sha256 == agent_sha256)


def _layout_score(
    layout: str, adapted: bool, returns: NDArray[np.float64], cells: Sequence[Cell], protocol: Protocol
) -> LayoutScore:
    seeds, partners = returns.shape[:2]
    means = returns.mean(axis=(2, 3))
    thresholds = []
    for soups in protocol.thresholds:
        count, undecided = statistics.threshold(returns.mean(axis=3), soups * DEFAULT_SOUP_REWARD)
        thresholds.append(ThresholdScore(soups, Estimate(*count), count.value / partners, undecided))
    curve = statistics.ordered(means)
    low = statistics.low_quantile(curve) if seeds > 1 else None
    return LayoutScore(
        layout=layout,
        adapted=adapted,
        partners=partners,
        mean=_estimate(returns),
        seats=_seats(returns),
        thresholds=tuple(thresholds),
        tail_quantile=_over_seeds(statistics.tail_quantile(means)),
        tail_mean=_over_seeds(statistics.tail_mean(means)),
        low_quantile=statistics.describe_low_quantile(means.mean(axis=1)) if seeds > 1 else None,
        curve=tuple(
            CurvePoint(r + 1, _over_seeds(curve[:, r]), None if low is None else float(low[r])) for r in range(partners)
        ),
        cells=tuple(sorted((c for c in cells if c.kind != FLOOR), key=lambda c: (c.mean.value, c.partner))),
        floors=tuple(c for c in cells if c.kind == FLOOR),
    )


def _over_seeds(values: NDArray[np.float64]) -> Estimate:
    return Estimate(*statistics.t_interval(values, lowest=0))
