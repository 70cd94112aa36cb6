"""From stored episodes to scores.

Axes: S training seeds, P partners, E episode indices, K seats of the scored agent.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.estimate import Estimate, t_interval
from overcooked_bench.evaluation import statistics
from overcooked_bench.evaluation.games.roster import FLOOR
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.protocol import Protocol
from overcooked_bench.evaluation.scores import Cell, CurvePoint, LayoutScore, ThresholdScore
from overcooked_bench.kitchen.layout import Layout


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
    for one in store.episodes():
        who = rows.setdefault(one.layout, {}).setdefault((one.partner, one.kind, one.partner_sha256), {})
        who[one.training_seed, one.episode, one.seat] = one.soup_reward, one.ego_soups, one.partner_soups
    adapted, scores, repetitions = store.adapted(), [], []
    rules = protocol.play
    shape = training_seeds, rules.episodes, len(rules.seats)
    for layout in layouts:
        tables = {who: _table(games, shape, rules.seats) for who, games in sorted(rows[layout].items())}
        counting = {who: table for who, table in tables.items() if who[1] != FLOOR}
        cells = [_cell(who, table, agent_sha256) for who, table in tables.items()]
        returns = np.stack([table[..., 0] for table in counting.values()], axis=1)  # (S, P, E, K)
        scores.append(_layout_score(layout, layout in adapted, returns, cells, protocol))
        repetitions.append(_repetitions(returns))
    overall = statistics.combined(repetitions, lowest=0) if repetitions else None
    return tuple(scores), overall


def describe_interval(training_seeds: int, episodes: int) -> str:
    """Says what the intervals are about."""
    if training_seeds > 1:
        return (
            f"95 % t intervals over {training_seeds} training seeds, for this pool of partners and given these start "
            "states and random streams, which all training seeds play."
        )
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
    return np.asarray(returns.mean(axis=(1, 2, 3) if len(returns) > 1 else (0, 1, 3)))


def _estimate(returns: NDArray[np.float64]) -> Estimate:
    return t_interval(_repetitions(returns), lowest=0)


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
    thresholds, soup_points = [], Layout.load(layout).soup_points
    for soups in protocol.report.thresholds:
        reached, undecided = statistics.threshold(returns.mean(axis=3), soups * soup_points)
        thresholds.append(ThresholdScore(soups, reached, reached.value / partners, undecided))
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
        soup_points=soup_points,
    )


def _over_seeds(values: NDArray[np.float64]) -> Estimate:
    return t_interval(values, lowest=0)
