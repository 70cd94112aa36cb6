"""Summarises cells as a score: every metric, for each layout, seat, stratum and partner."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any, Final

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.cells import Cells, read_cells
from overcooked_bench.evaluation.conduct import CONDUCT, count_conduct
from overcooked_bench.evaluation.games.facts import read_facts
from overcooked_bench.evaluation.games.replayed import check_returns, read_settings
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.metric import Figured, Metric, Params, Slice, chosen_metrics
from overcooked_bench.evaluation.protocol import Protocol, Report
from overcooked_bench.evaluation.ranking import different_runs, why_unranked
from overcooked_bench.evaluation.scores import (
    EPISODES_FILE,
    SCHEMA,
    Declined,
    LayoutFacts,
    Row,
    ScenarioScore,
    Scores,
    Source,
    in_folder,
)
from overcooked_bench.evaluation.statistics import describe_low_quantile

_ACROSS: Final = {"stratum", "home"}
"""Entries of a row that means over layouts are computed for, too."""


def summarise(
    store: Store,
    rules: Protocol,
    *,
    training_seeds: int,
    finished: Sequence[str],
    declined: Sequence[Declined] = (),
    faults: Sequence[str] = (),
    scenarios: ScenarioScore | None = None,
    run: Mapping[str, Any] | None = None,
    conduct: bool = False,
) -> Scores:
    """Computes the score of what a store holds.

    Args:
        store: Where the episodes are, and who is scored.
        rules: What was played.
        training_seeds: S.
        finished: Layouts of which every block is in the store.
        declined: Layouts that the agent does not play.
        faults: What it did wrong.
        scenarios: How it did in the cooperation scenarios.
        run: Facts of this run.
        conduct: Whether to replay the episodes for what the chefs do, if the report has metrics of it.

    Raises:
        StoreError: Blocks were changed after they were written, or what identifies the score cannot be used.
    """
    facts, play = read_facts(store), rules.play
    adapted, metrics = store.adapted(), chosen_metrics(rules.report)
    counted = conduct and any(metric.facts.name in CONDUCT for metric in metrics)
    count = partial(count_conduct, cooking=play.cooking, horizon=play.horizon) if counted else None
    found = read_cells(store, finished, training_seeds, play.episodes, play.seats, count)
    cells, missing = list(found.values()), _missing(rules, finished, declined)
    rows = compute_rows(cells, metrics, rules.report, overall=missing is None)
    interval = describe_interval(training_seeds, play.episodes, rules.report)
    different = different_runs(store, found.keys()) if cells and training_seeds > 1 else training_seeds
    if different < training_seeds:
        rows = tuple(msgspec.structs.replace(row, low=None, high=None, error=None) for row in rows)
        interval = f"No intervals: {different} of {training_seeds} training runs differ, the others are copies."
    scores = Scores(
        schema=SCHEMA,
        protocol=Source(rules.name, facts.protocol),
        settings=rules,
        agent=Source(facts.agent_name, facts.agent),
        pool=None if facts.pool == "none" else Source(facts.pool_name or str(play.pool), facts.pool),
        seed=facts.seed,
        salt=facts.salt or play.salt,
        training_seeds=training_seeds,
        interval=interval,
        overall=None,
        unranked=missing,
        layouts=tuple(layout_facts(one, one.layout in adapted) for one in cells),
        declined=tuple(declined),
        faults=tuple(faults),
        metrics=tuple(metric.facts for metric in metrics if metric.facts.name in {row.metric for row in rows}),
        rows=rows,
        scenarios=scenarios,
        run=dict(run or {}),
    )
    first = scores.find(scores.headline)
    unranked = missing or why_unranked(scores, different)
    return msgspec.structs.replace(scores, overall=first and first.estimate, unranked=unranked)


def recompute(source: str | Path, report: Report | None = None, declined: Sequence[Declined] = ()) -> Scores:
    """Computes a score again from its stored episodes alone, all of which are replayed.

    Args:
        source: The folder of a score, or its episodes.sqlite, of this schema or an older one.
        report: How the games are scored, instead of as the store says: scores of the same games whose protocols report
            them differently become comparable.
        declined: Layouts that the agent does not play, which episodes do not say.

    Returns:
        The numbers of the layouts that were finished, without scenarios.

    Raises:
        StoreError: There is no such store, or it was changed.
    """
    with Store(in_folder(source, EPISODES_FILE)) as store:
        rules = read_settings(store)
        if report is not None:
            rules = msgspec.structs.replace(rules, report=report)
        check_returns(store, rules.play.cooking, rules.play.horizon)
        blocks, episodes = store.blocks(), rules.play.episodes
        seeds = read_facts(store).training_seeds or 1 + max((run for _, run, _ in blocks), default=0)
        known = Counter(layout for layout, run, episode in blocks if run < seeds and episode < episodes)
        finished = [layout for layout in rules.play.layouts if known[layout] == seeds * episodes]
        return summarise(store, rules, training_seeds=seeds, finished=finished, declined=declined, conduct=True)


def compute_rows(cells: Sequence[Cells], metrics: Sequence[Metric], report: Report, overall: bool) -> tuple[Row, ...]:
    """Computes every metric.

    Args:
        cells: One per layout.
        metrics: Which.
        report: The protocol's parameters of metrics, and its estimators.
        overall: Whether means over the layouts are wanted: all layouts of the protocol are there.

    Returns:
        Rows in the order of layouts, slices and metrics; the means over layouts first.
    """
    rows: list[Row] = []
    across: dict[tuple[Any, ...], list[tuple[Cells, NDArray[np.float64]]]] = {}
    for one in cells:
        for index, metric in enumerate(metrics):
            for about, part in slices(one, metric.by):
                for params in metric.params(report, part):
                    values = np.asarray(metric.per_repetition(part, **params), np.float64)
                    if not len(values):
                        continue
                    if "overall" in metric.by and not about.keys() - _ACROSS:
                        key = index, tuple(about.items()), tuple(params.items())
                        across.setdefault(key, []).append((part, values))
                    found = metric.estimate(values, [part], report, params)
                    rows.append(_row(metric, params, values, found, layout=one.layout, **about))
    means = []
    for (index, slice_, key), parts in across.items():
        arrays = [values for _, values in parts]
        if overall and len(arrays) == len(cells) and len({len(values) for values in arrays}) == 1:
            values, params = np.stack(arrays).mean(axis=0), dict(key)
            found = metrics[index].estimate(values, [part for part, _ in parts], report, params)
            means.append(_row(metrics[index], params, values, found, **dict(slice_)))
    return (*means, *rows)


def layout_facts(cells: Cells, adapted: bool) -> LayoutFacts:
    """Says what was played on a layout."""
    seeds = cells.counting.means.mean(axis=1)
    remark = describe_low_quantile(seeds) if len(seeds) > 1 else None
    return LayoutFacts(cells.layout, adapted, cells.soup_points, cells.partners, remark)


def describe_interval(training_seeds: int, episodes: int, report: Report) -> str:
    """Says what the intervals are about."""
    if training_seeds > 1:
        return (
            f"95 % t intervals over {training_seeds} training seeds, for this pool of partners and given these start "
            "states and random streams, which all training seeds play."
        )
    if report.estimators == "repaired":
        return (
            "95 % t intervals over the partners of each stratum and their start states, of one training run; they say "
            "nothing about retraining. With a single partner they are over episode blocks."
        )
    if episodes > 1:
        return (
            f"95 % t intervals over {episodes} episode blocks of one training run, for this pool of partners; "
            "they say nothing about retraining."
        )
    return "No intervals: a single episode block of one training run."


def _missing(rules: Protocol, finished: Sequence[str], declined: Sequence[Declined]) -> str | None:
    """Says why there is no overall score, None if there is one."""
    refused = [one.layout for one in declined]
    others = [layout for layout in rules.play.layouts if layout not in (*refused, *finished)]
    parts = [f"{', '.join(refused)} declined"] if refused else []
    parts += [f"{', '.join(others)} not played to the end"] if others else []
    return "; ".join(parts) or None


def slices(cells: Cells, by: Sequence[Slice]) -> Iterator[tuple[Mapping[str, Any], Cells]]:
    """Yields what a metric is about, as entries of a `Row`, and the cells that it is computed from."""
    counting = cells.counting
    if "layout" in by:
        yield {}, counting
    if "seat" in by:
        for seat in cells.seats:
            yield {"seat": seat}, counting.on_seat(seat)
    if "side" in by:
        yield from _sides(counting)
    for entry in ("stratum", "home"):
        if entry in by:
            yield from _kinds(counting, entry)
    for index, label in enumerate(cells.partners):
        own = cells.with_partners([index])
        if "partner" in by:
            yield {"partner": label.name}, own
        if "partner and seat" in by:
            for seat in cells.seats:
                yield {"partner": label.name, "seat": seat}, own.on_seat(seat)


def _sides(cells: Cells) -> Iterator[tuple[Mapping[str, Any], Cells]]:
    """Yields the sides of the floor that the scored agent starts on, where there are several."""
    sides = np.unique(cells.sides).tolist()
    for side in sides if len(sides) > 1 else []:
        if (there := cells.on_side(side)) is not None:
            yield {"side": side}, there


def _kinds(cells: Cells, entry: str) -> Iterator[tuple[Mapping[str, Any], Cells]]:
    """Yields the partners of each stratum, or at home and away; none where all are away, or nobody knows."""
    kinds = [getattr(label, entry) for label in cells.partners]
    present = sorted({kind for kind in kinds if kind is not None})
    for kind in present if present != [False] else []:
        yield {entry: kind}, cells.with_partners(index for index, own in enumerate(kinds) if own == kind)


def _row(metric: Metric, params: Params, values: NDArray[np.float64], found: Figured, **about: Any) -> Row:
    return Row(
        metric=metric.facts.name,
        params=dict(params),
        value=found.estimate.value,
        low=found.estimate.low,
        high=found.estimate.high,
        error=found.error,
        per_repetition=tuple(values.tolist()),
        **about,
    )
