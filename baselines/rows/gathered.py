"""Turns what was played into the records of the page."""

from collections.abc import Sequence
from typing import Final

from overcooked_bench.agents.entries import ShippedEntry
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.scores import MEAN, Scores, Source

from ..building.costs import read_costs
from .playing import Games, PlayedEntry
from .records import SCHEMA, Cost, EntryRecord, LayoutRecord, Ordered, Seeds, Standings

N: Final = "n"


def gather(played: Sequence[PlayedEntry], games: Games, reference: str) -> Standings:
    """Gathers all entries, the highest N first, and those without an N last.

    Args:
        played: What was played of each.
        games: What was played.
        reference: Name of the reference agent.
    """
    found = [entry_record(one) for one in played]
    pool, strangers = played[0].scores.pool, Pool.load(games.strangers)
    rule = games.thesis.report.ordered
    met = next((one.criterion.pool for one in played if one.criterion), None)
    assert pool is not None
    assert rule is not None  # `ordered_cross_play` refuses a protocol without it
    return Standings(
        schema=SCHEMA,
        protocol=played[0].scores.protocol,
        pool=pool,
        criterion=met.name if met else None,
        thesis=(Source(games.thesis.name, games.thesis.sha256), Source(strangers.name, strangers.hash)),
        positions=rule.positions,
        quantile=rule.quantile,
        reference=reference,
        entries=tuple(sorted(found, key=lambda one: (one.n is None, -one.n.value if one.n else 0.0, one.name))),
    )


def entry_record(played: PlayedEntry) -> EntryRecord:
    """Writes the record of an entry."""
    scores, scenarios = played.scores, played.scores.scenarios
    strata = dict.fromkeys(row.stratum for row in scores.select(N, layout=None, partner=None) if row.stratum)
    return EntryRecord(
        name=played.name,
        sha256=scores.agent.sha256,
        what=_what(played.entry),
        training_seeds=scores.training_seeds,
        n=_number(scores, N),
        by_seed=_by_seed(scores),
        h50=_number(scores, "h50"),
        strata={name: found for name in strata if (found := _number(scores, N, stratum=name))},
        home=_number(scores, N, home=True),
        away=_number(scores, N, home=False),
        worst_third=_number(scores, "worst_third"),
        mean=_number(scores, MEAN),
        self_play=_number(scores, "self_play"),
        criterion=_number(played.criterion, MEAN) if played.criterion else None,
        passed=scenarios.total.passed if scenarios else 0.0,
        attempted=scenarios.total.attempted if scenarios else 0.0,
        scenarios=scenarios.total.share if scenarios else None,
        thesis=_ordered(played),
        layouts=tuple(_layout(played, one.layout) for one in scores.layouts),
        cost=_cost(played.entry) if played.entry else None,
    )


def _number(scores: Scores, metric: str, **about: object) -> Estimate | None:
    row = scores.find(metric, **about)
    return None if row is None else row.estimate


def _by_seed(scores: Scores, layout: str | None = None) -> tuple[float, ...]:
    """Returns N of each training seed; of a single one N itself, whose repetitions are episode blocks."""
    row = scores.find(N, layout=layout)
    if row is None:
        return ()
    return row.per_repetition or () if scores.training_seeds > 1 else (row.value,)


def _what(entry: ShippedEntry | None) -> str:
    """Returns the method and the configuration of an entry's runs."""
    if entry is None:
        return "scripted"
    trained = next(iter(entry.runs.values()))[0].trained
    return " ".join(filter(None, (trained.method, trained.configuration)))


def _cost(entry: ShippedEntry) -> Cost | None:
    """Adds up what an entry's runs cost; None if that of one is not recorded."""
    costs = read_costs(entry.pool.folder)
    names = [f"{layout}/{run.name}" for layout, runs in entry.runs.items() for run in runs]
    if not costs.keys() >= set(names):
        return None
    found = [costs[name] for name in names]
    hours = sum(one.seconds for one in found) / 3600
    return Cost(hours, sum(one.joint_steps for one in found), len(found), sum(one.partner_runs for one in found))


def _layout(played: PlayedEntry, layout: str) -> LayoutRecord:
    scores = played.scores
    n, h50, mean = (_number(scores, metric, layout=layout) for metric in (N, "h50", MEAN))
    assert n is not None  # a pool without bounds is refused before
    assert h50 is not None
    assert mean is not None
    seeds = next((one for one in played.seeds if one.layout == layout), None)
    return LayoutRecord(
        layout=layout,
        n=n,
        by_seed=_by_seed(scores, layout),
        h50=h50,
        mean=mean,
        self_play=_number(scores, "self_play", layout=layout),
        seeds=Seeds(seeds.self_play, seeds.cross_play, seeds.ratio) if seeds else None,
    )


def _ordered(played: PlayedEntry) -> Ordered | None:
    """Returns an entry's line; None if it is not in every figure, as where it was trained with all partners."""
    found = played.ordered
    whole = next((one for one in found.lines if one.entrant == played.name), None)
    if whole is None:
        return None
    by_layout = {
        figure.layout: one.average for figure in found.figures for one in figure.lines if one.entrant == played.name
    }
    return Ordered(whole.rows, whole.values, whole.average, by_layout)
