"""Numbers of a layout, from the manifests of shipped pools and from `baselines/results/v1-entries.json`."""

from functools import lru_cache
from pathlib import Path
from statistics import median
from typing import Final, NamedTuple

from overcooked_bench.agents.pools.manifest import read_manifest
from overcooked_bench.agents.pools.pool import find_pool, shipped_pools
from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.baselines.rows.records import Standings
from overcooked_bench.baselines.v1_entries import read_standings

SCORING: Final = "v1"
TRAINING: Final = "train-v1"
_RESULTS: Final = Path(__file__).parents[2] / "baselines/results/v1-entries.json"


class Best(NamedTuple):
    """The highest mean return on record.

    Attributes:
        points: Points per episode.
        who: The two agents.
    """

    points: float
    who: str


class LayoutNumbers(NamedTuple):
    """What was measured on a layout; None where nothing was.

    Attributes:
        best: The highest mean return.
        ceilings: Points per episode that the best known responder reaches: lowest, median, highest over partners.
        floors: The same of the better of `stay` and `random`.
        self_play: Lowest and highest return with itself, number of agents, pool.
    """

    best: Best | None
    ceilings: tuple[float, float, float] | None
    floors: tuple[float, float, float]
    self_play: tuple[float, float, int, str] | None


class Reference(NamedTuple):
    """A reference entry on a layout.

    Attributes:
        name: Its name.
        training_seeds: How often it was trained.
        n: N with its interval, as text.
        interval: Its ends.
    """

    name: str
    training_seeds: int
    n: str
    interval: tuple[float, float]


def reached(layout: str) -> LayoutNumbers:
    """Collects what the shipped pools record on a layout."""
    best: list[Best] = []
    for pool in shipped_pools():
        for entry in _on(pool, layout):
            label = f"`{pool}/{layout}/{entry.name}`"
            if entry.training:
                best.append(Best(entry.training.self_play.mean, f"{label} with a copy of itself"))
            best += [Best(one.ceiling, f"`{one.responder}` with {label}") for one in entry.bounds or ()]
    for entry in _standings().entries:
        itself = [one.self_play.value for one in entry.layouts if one.layout == layout and one.self_play]
        best += [Best(points, f"`{entry.name}` with a copy of itself") for points in itself]
    bounds = [bound for entry in _on(SCORING, layout) for bound in entry.bounds or ()]
    trained = [one.trained.self_play.mean for one in _on(TRAINING, layout) if one.training and one.trained.done == 1]
    return LayoutNumbers(
        max(best, default=None),
        _span([bound.ceiling for bound in bounds]) if bounds else None,
        _span([bound.floor for bound in bounds]) if bounds else (0.0, 0.0, 0.0),
        (min(trained), max(trained), len(trained), TRAINING) if trained else None,
    )


def standings(layout: str) -> list[Reference]:
    """Returns the reference entries that were scored on a layout, the highest N first."""
    found = []
    for entry in _standings().entries:
        for one in entry.layouts:
            if one.layout == layout and one.n.low is not None and one.n.high is not None:
                found.append(Reference(entry.name, entry.training_seeds, one.n.text(2), (one.n.low, one.n.high)))
    return sorted(found, key=lambda one: -sum(one.interval))


def _on(pool: str, layout: str) -> list[Entry]:
    return [entry for entry in read_manifest(find_pool(pool)).entries if entry.layout == layout]


@lru_cache(1)
def _standings() -> Standings:
    return read_standings(_RESULTS)


def _span(values: list[float]) -> tuple[float, float, float]:
    return min(values), median(values), max(values)
