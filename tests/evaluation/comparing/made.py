"""Scores of made-up returns."""

import numpy as np

from overcooked_bench.evaluation.cells import Cells, PartnerLabel, SideBound
from overcooked_bench.evaluation.metric import find_metrics
from overcooked_bench.evaluation.protocol import Play, Protocol, Report
from overcooked_bench.evaluation.scores import SCHEMA, LayoutFacts, Scores, Source
from overcooked_bench.evaluation.summary import compute_rows

LAYOUTS = ("cramped_room", "coordination_ring")
STRATA = ("own", "other", "human", "scripted")
REPORT = Report(
    thresholds=(3,), metrics=("n", "h50", "mean", "threshold"), headlines=("n", "h50"), estimators="repaired"
)
PLAY = Play(
    pool="made",
    layouts=LAYOUTS,
    cooking="auto",
    horizon=400,
    start="random",
    object_probability=0,
    seats=(0, 1),
    episodes=3,
    mode="sample",
    salt="pepper",
)


def partners(each=3, sides=1):
    """Some partners of each of four strata, with whom 0 to 100 points can be reached from any side."""
    bounds = tuple(SideBound(side, 0, 100) for side in range(sides))
    return tuple(
        PartnerLabel(f"{stratum}-{i}", "trained", f"{stratum}{i}", stratum, bounds=bounds)
        for stratum in STRATA
        for i in range(each)
    )


def scores(name, means, report=REPORT, played=PLAY, labels=None, sides=0):
    """A score.

    Args:
        name: The agent's.
        means: (L, S, P) or (L, S, P, E) points on layouts, of training seeds, with partners.
        report: How it is reported.
        played: What was played.
        labels: The partners; as many of four strata by default.
        sides: Where the agent starts from its two seats.
    """
    given = np.asarray(means, float)
    labels = labels or partners(given.shape[2] // 4)
    metrics = [metric for metric in find_metrics() if metric.facts.name in ("mean", *report.metrics)]
    cells = []
    for layout, one in zip(LAYOUTS, given, strict=False):
        blocks = one[..., None] if one.ndim == 3 else np.repeat(one[..., None], 3, axis=2)[..., None]
        returns = np.repeat(blocks, 2, axis=3)
        zeros, there = np.zeros(returns.shape), np.broadcast_to(np.asarray(sides), returns.shape)
        cells.append(Cells(layout, 20.0, labels, (0, 1), returns, zeros, zeros, there))
    rules = Protocol(name="made", version=1, play=played, report=report)
    return Scores(
        schema=SCHEMA,
        protocol=Source(rules.name, rules.sha256),
        settings=rules,
        agent=Source(name, name.encode().hex().ljust(64, "0")),
        pool=Source("made", "1" * 64),
        seed=0,
        salt="pepper",
        training_seeds=given.shape[1],
        interval="",
        overall=None,
        unranked=None,
        layouts=tuple(LayoutFacts(one.layout, False, 20.0, labels) for one in cells),
        declined=(),
        faults=(),
        metrics=tuple(metric.facts for metric in metrics),
        rows=compute_rows(cells, metrics, report, overall=len(cells) == len(played.layouts)),
        scenarios=None,
        run={},
    )


def method(seed=0, level=60.0, seeds=5, name="method", **more):
    """A method whose training seeds, and they with each partner, vary."""
    rng = np.random.default_rng(seed)
    runs = rng.normal(0, 6, (2, seeds, 1)) + rng.normal(0, 10, (2, seeds, 12))
    return scores(name, level + runs + 5 * np.arange(12), **more)


def agent(seed=0, level=60.0, name="agent", **more):
    """An agent that varies with each partner and start state."""
    rng = np.random.default_rng(seed)
    returns = level + rng.normal(0, 10, (2, 1, 12, 1)) + rng.normal(0, 10, (2, 1, 12, 3))
    return scores(name, returns + 5 * np.arange(12)[:, None], **more)
