"""Writes what the leaderboard shows of a shipped entry: its score, what a submission would say, and its worst games."""

from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.agents.pools.pool import Pool, shipped_pools
from overcooked_bench.evaluation.scores import MEAN, SCORES_FILE, Row, Scores
from overcooked_bench.files import write_whole
from overcooked_bench.leaderboard.site.entries import FACTS_FILE
from overcooked_bench.leaderboard.site.worst import WORST_FILE, find_worst, write_worst
from overcooked_bench.leaderboard.submission.manifest import SCHEMA, Manifest

from ..building.costs import RunCost, read_costs
from .playing import PlayedEntry

_OF_PARTNERS: Final = ("n", MEAN)
"""Metrics that the page shows of single partners."""


def write_row(played: PlayedEntry, episodes: Path, folder: Path) -> None:
    """Writes the row of an entry.

    Args:
        played: What was played.
        episodes: The folder of its score under the protocol.
        folder: Where to write three files; it is made.
    """
    folder.mkdir(parents=True, exist_ok=True)
    write_whole(folder / SCORES_FILE, msgspec.json.encode(_small(played.scores)) + b"\n")
    facts = msgspec.json.format(msgspec.json.encode(facts_of(played)), indent=1)
    write_whole(folder / FACTS_FILE, facts + b"\n")
    write_worst(played.scores, find_worst(played.scores, episodes), folder / WORST_FILE)


def _small(scores: Scores) -> Scores:
    """Returns a score without what no page shows: what partners do, and when it was played."""
    rows = tuple(_row(row) for row in scores.rows if row.partner is None or row.metric in _OF_PARTNERS)
    run = {"versions": scores.run.get("versions", {})}
    return msgspec.structs.replace(scores, rows=rows, run=run)


def _row(row: Row) -> Row:
    return row if row.partner is None else msgspec.structs.replace(row, per_repetition=None, error=None)


def facts_of(played: PlayedEntry) -> Manifest:
    """Returns what a submission.yaml would say of an entry, as far as its manifest and its costs say it."""
    entry = played.entry
    if entry is None:
        return _facts(played.name, method="rules, no training", observation="state")
    trained = next(iter(entry.runs.values()))[0].trained
    known = read_costs(entry.pool.folder)
    costs = [
        known.get(f"{layout}/{run.name}", RunCost(0.0, run.trained.steps, 0))
        for layout, runs in entry.runs.items()
        for run in runs
    ]
    return _facts(
        played.name,
        method=" ".join(filter(None, (trained.method, trained.configuration))),
        observation=str(trained.settings.get("observation", "")),
        pools=tuple(name for name in trained.settings.get("partners", ()) if name in shipped_pools()),
        joint_steps=sum(cost.joint_steps for cost in costs) // entry.training_seeds,
        partner_runs=sum(cost.partner_runs for cost in costs) // entry.training_seeds,
        training_seeds=entry.training_seeds,
    )


def _facts(
    name: str,
    *,
    method: str,
    observation: str,
    pools: tuple[str, ...] = (),
    joint_steps: int = 0,
    partner_runs: int = 0,
    training_seeds: int = 1,
) -> Manifest:
    return Manifest(
        schema=SCHEMA,
        name=name,
        contact="",
        licence="MIT",
        link=None,
        commit=None,
        method=method,
        joint_steps=joint_steps,
        partner_runs=partner_runs,
        human_data=any(_has_people(pool) for pool in pools),
        training_pools=pools,
        selection_pools=(),
        observation=observation,
        training_seeds=training_seeds,
        pledge=True,
    )


def _has_people(name: str) -> bool:
    """Returns whether a pool has partners that were made from games of people."""
    pool = Pool.load(name)
    return any(one.stratum == "human" for layout in pool.layouts for one in pool.partners(layout))
