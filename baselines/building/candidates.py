"""Candidates for the quotas of a pool: which of them are fit, and what is trained where there are too few."""

from collections.abc import Collection, Mapping, Sequence
from pathlib import Path
from typing import Final

from overcooked_bench.agents.pools.manifest import MANIFEST, policies, read_manifest
from overcooked_bench.agents.pools.records import Entry

from .build import PoolBuildError, labelled
from .config import PoolConfig, Run

CANDIDATES: Final = "candidates"
"""The pool of all candidates, in the folder of the runs."""
LEAST: Final = 40.0
"""A candidate has to reach so many points with itself, and a partner to leave so many between floor and ceiling."""
_EXEMPT: Final = ("human", "half-trained", "untrained")

Key = tuple[str, str]
"""Layout and name of an agent."""


def trained(config: PoolConfig, pool: Path) -> dict[Key, Entry]:
    """Returns the candidates that are trained, by layout and name, with the strata that the configuration gives."""
    if not (pool / MANIFEST).is_file():
        return {}
    runs = {(run.layout, run.name): run for run in config.all_runs}
    return {
        key: labelled(runs[key], entry)
        for entry in policies(read_manifest(pool))
        if (key := (entry.layout, entry.name)) in runs
    }


def fit(entry: Entry) -> bool:
    """Returns whether a candidate may be chosen: it reaches `LEAST` points with itself, or is not meant to.

    Agents that are not trained to the end, those made from people, and scripted ones are not held to this.
    """
    training = entry.training
    return training is None or training.stratum in _EXEMPT or training.self_play.mean >= LEAST


def candidates(
    config: PoolConfig, quota: str, layout: str, held: Mapping[Key, Entry], out: Collection[Key] = ()
) -> list[Entry]:
    """Lists the fit candidates for a quota on a layout, in the order of the configuration.

    Args:
        config: The pool.
        quota: One of its quotas.
        layout: One of its layouts.
        held: The candidates that are trained.
        out: Those that are not to be chosen.
    """
    runs = [run for run in [*config.runs(), *config.further(layout, quota)] if _is_for(run, quota, layout)]
    trained = [held[key] for run in runs if (key := (layout, run.name)) in held]
    beside = [one.entry(layout) for one in config.scripted if one.quota == quota]
    return [entry for entry in [*trained, *beside] if fit(entry) and (layout, entry.name) not in out]


def needed(
    config: PoolConfig, held: Mapping[Key, Entry], out: Collection[Key] = (), layouts: Sequence[str] | None = None
) -> list[Run]:
    """Lists the runs that are still to be trained before the pool can be chosen.

    Those that the configuration counts come first. Where they are all trained and too few are fit, one further run
    follows after the other, so that the same ones are trained whatever the number of workers.

    Args:
        config: The pool.
        held: The candidates that are trained.
        out: Those that are not to be chosen.
        layouts: Only the runs on these.

    Raises:
        PoolBuildError: A quota cannot be met; says by how much, and what can be done.
    """
    places = [layout for layout in config.layouts if layouts is None or layout in layouts]
    runs = [run for run in config.runs() if run.layout in places and (run.layout, run.name) not in held]
    unfinished = {(run.layout, run.group.quota) for run in runs}
    for layout in places:
        for quota, number in config.quotas_on(layout).items():
            if (layout, quota) in unfinished:
                continue
            have = len(candidates(config, quota, layout, held, out))
            if have >= number:
                continue
            further = [run for run in config.further(layout, quota) if (layout, run.name) not in held]
            if not further:
                raise PoolBuildError(
                    f"{layout}: {have} candidates are fit for the quota {quota!r}, which is {number}, and its groups "
                    "have no further seeds; lower the quota, add a group, or leave more seeds between groups (`first`)"
                )
            runs.append(further[0])
    return runs


def _is_for(run: Run, quota: str, layout: str) -> bool:
    return run.group.quota == quota and run.layout == layout
