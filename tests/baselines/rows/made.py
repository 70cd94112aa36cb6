"""Records of made-up entries."""

import numpy as np

from overcooked_bench.baselines.rows.records import SCHEMA, Cost, EntryRecord, LayoutRecord, Ordered, Seeds, Standings
from overcooked_bench.estimate import Estimate, t_interval
from overcooked_bench.evaluation.scores import Source

LAYOUTS = "cramped_room", "coordination_ring"


def entry(name, level, seeds=10, spread=0.02, own=200.0, crossed=100.0, **others):
    """An entry whose training seeds have N around a level, on two layouts; with one another they reach `crossed`."""
    rng = np.random.default_rng(sum(map(ord, name)))
    by_layout = level + rng.normal(0, spread, (2, seeds))
    runs = by_layout.mean(axis=0)
    share, points = Estimate(level, level - 0.1, level + 0.1), Estimate(100 * level, 90 * level, 110 * level)
    met = Seeds(*(Estimate(value, value - 10, value + 10) for value in (own, crossed)), Estimate(crossed / own))
    layouts = tuple(
        LayoutRecord(
            layout=layout,
            n=t_interval(values),
            by_seed=tuple(values.tolist()),
            h50=share,
            mean=points,
            self_play=Estimate(own),
            seeds=met if seeds > 1 else None,
        )
        for layout, values in zip(LAYOUTS, by_layout, strict=True)
    )
    given = {
        "sha256": "0" * 64,
        "what": "self-play fast",
        "training_seeds": seeds,
        "n": t_interval(runs),
        "by_seed": tuple(runs.tolist()),
        "h50": share,
        "strata": {"own": share, "human": share},
        "home": share,
        "away": None,
        "worst_third": share,
        "mean": points,
        "self_play": Estimate(own),
        "criterion": points,
        "passed": 12.5,
        "attempted": 50.0,
        "scenarios": Estimate(0.25, 0.2, 0.3),
        "thesis": Ordered(seeds, (0.1, 0.2), 0.15, {"cramped_room": 0.15}),
        "layouts": layouts,
        "cost": Cost(1.5, 12_000_000, 10, 80),
    }
    return EntryRecord(name=name, **(given | others))


def standings(*entries):
    """The records of some entries and `greedy`."""
    everyone = [*entries, entry("greedy", 0.82, seeds=1, cost=None)]
    return Standings(
        schema=SCHEMA,
        protocol=Source("v1", "a" * 64),
        pool=Source("v1", "b" * 64),
        criterion="human-test",
        thesis=(Source("thesis", "c" * 64), Source("train-v1", "d" * 64)),
        positions=(0.5, 1.0),
        quantile=0.15,
        reference="greedy",
        entries=tuple(sorted(everyone, key=lambda one: (one.n is None, -one.n.value if one.n else 0.0))),
    )
