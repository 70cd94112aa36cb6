"""Summarises cells as a score: every metric, for each layout, seat, stratum and partner."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.cells import Cells, read_cells
from overcooked_bench.evaluation.games.replayed import check_returns, read_settings
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.metric import Metric, Params, Slice, find_metrics
from overcooked_bench.evaluation.protocol import Protocol, Report
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

    Raises:
        StoreError: Blocks were changed after they were written.
    """
    facts, play = store.facts, rules.play
    found = read_cells(store, finished, training_seeds, play.episodes, play.seats)
    cells, adapted, metrics = list(found.values()), store.adapted(), find_metrics()
    unranked = _unranked(rules, finished, declined)
    rows = compute_rows(cells, metrics, rules.report, overall=unranked is None)
    pool = facts.get("pool", "none")
    scores = Scores(
        schema=SCHEMA,
        protocol=Source(rules.name, facts.get("protocol", "")),
        settings=rules,
        agent=Source(facts.get("agent_name", ""), facts.get("agent", "")),
        pool=None if pool == "none" else Source(facts.get("pool_name", str(play.pool)), pool),
        seed=int(facts.get("seed", "0")),
        salt=facts.get("salt", play.salt),
        training_seeds=training_seeds,
        interval=describe_interval(training_seeds, play.episodes),
        overall=None,
        unranked=unranked,
        layouts=tuple(layout_facts(one, one.layout in adapted) for one in cells),
        declined=tuple(declined),
        faults=tuple(faults),
        metrics=tuple(metric.facts for metric in metrics),
        rows=rows,
        scenarios=scenarios,
        run=dict(run or {}),
    )
    mean = scores.find()
    return msgspec.structs.replace(scores, overall=mean and mean.estimate)


def recompute(source: str | Path) -> Scores:
    """Computes a score again from its stored episodes alone, all of which are replayed.

    Args:
        source: The folder of a score, or its episodes.sqlite, of this schema or an older one.

    Returns:
        The numbers of the layouts that were finished, without scenarios.

    Raises:
        StoreError: There is no such store, or it was changed.
    """
    with Store(in_folder(source, EPISODES_FILE)) as store:
        rules = read_settings(store)
        check_returns(store, rules.play.cooking, rules.play.horizon)
        blocks, episodes = store.blocks(), rules.play.episodes
        try:
            seeds = int(store.facts.get("training_seeds", 1 + max((run for _, run, _ in blocks), default=0)))
        except ValueError as error:
            raise StoreError(f"{store.file}: its number of training seeds is unclear ({error})") from error
        known = Counter(layout for layout, run, episode in blocks if run < seeds and episode < episodes)
        finished = [layout for layout in rules.play.layouts if known[layout] == seeds * episodes]
        return summarise(store, rules, training_seeds=seeds, finished=finished)


def compute_rows(cells: Sequence[Cells], metrics: Sequence[Metric], report: Report, overall: bool) -> tuple[Row, ...]:
    """Computes every metric.

    Args:
        cells: One per layout.
        metrics: Which.
        report: The protocol's parameters of metrics.
        overall: Whether means over the layouts are wanted: all layouts of the protocol are there.

    Returns:
        Rows in the order of layouts, slices and metrics; the means over layouts first.
    """
    rows: list[Row] = []
    across: dict[tuple[int, tuple[Any, ...]], list[NDArray[np.float64]]] = {}
    for one in cells:
        for index, metric in enumerate(metrics):
            for about, part in _slices(one, metric.by):
                for params in metric.params(report, part):
                    values = np.asarray(metric.per_repetition(part, **params), np.float64)
                    if not len(values):
                        continue
                    if "overall" in metric.by and not about:
                        across.setdefault((index, tuple(params.items())), []).append(values)
                    estimate = metric.estimate(values, part, **params)
                    rows.append(_row(metric, params, values, estimate, layout=one.layout, **about))
    means = []
    for (index, key), arrays in across.items():
        if overall and len(arrays) == len(cells) and len({len(values) for values in arrays}) == 1:
            values = np.stack(arrays).mean(axis=0)
            means.append(_row(metrics[index], dict(key), values, metrics[index].estimate(values)))
    return (*means, *rows)


def layout_facts(cells: Cells, adapted: bool) -> LayoutFacts:
    """Says what was played on a layout."""
    seeds = cells.counting.means.mean(axis=1)
    remark = describe_low_quantile(seeds) if len(seeds) > 1 else None
    return LayoutFacts(cells.layout, adapted, cells.soup_points, cells.partners, remark)


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


def _unranked(rules: Protocol, finished: Sequence[str], declined: Sequence[Declined]) -> str | None:
    """Says why there is no overall score, None if there is one."""
    refused = [one.layout for one in declined]
    others = [layout for layout in rules.play.layouts if layout not in (*refused, *finished)]
    parts = [f"{', '.join(refused)} declined"] if refused else []
    parts += [f"{', '.join(others)} not played to the end"] if others else []
    return "; ".join(parts) or None


def _slices(cells: Cells, by: Sequence[Slice]) -> Iterator[tuple[Mapping[str, Any], Cells]]:
    """Yields what a metric is about, and the cells that it is computed from."""
    counting = cells.counting
    if "layout" in by:
        yield {}, counting
    if "seat" in by:
        for seat in cells.seats:
            yield {"seat": seat}, counting.on_seat(seat)
    if "stratum" in by:
        for stratum in sorted({label.stratum for label in counting.partners}):
            members = [index for index, label in enumerate(counting.partners) if label.stratum == stratum]
            yield {"stratum": stratum}, counting.with_partners(members)
    for index, label in enumerate(cells.partners):
        own = cells.with_partners([index])
        if "partner" in by:
            yield {"partner": label.name}, own
        if "partner and seat" in by:
            for seat in cells.seats:
                yield {"partner": label.name, "seat": seat}, own.on_seat(seat)


def _row(metric: Metric, params: Params, values: NDArray[np.float64], estimate: Estimate, **about: Any) -> Row:
    return Row(
        metric=metric.facts.name,
        params=dict(params),
        value=estimate.value,
        low=estimate.low,
        high=estimate.high,
        per_repetition=tuple(values.tolist()),
        **about,
    )
