"""Builds a pool from its configuration: trains the missing agents in parallel and resumes after any stop.

Each run has its own folder, in which it is resumed; when it has ended, the folder holds its agents and their entries.
They are then copied into the pool, and the manifest is rewritten atomically. What the pool holds is not trained
again; what comes out depends on the configuration alone, not on stops, processes or order.
"""

import json
import os
from dataclasses import asdict
from pathlib import Path
from typing import Any, Final

import msgspec

from overcooked_bench.agents.policies.policy import PolicyFiles, policy_files
from overcooked_bench.agents.pools.manifest import (
    FORMAT,
    MANIFEST,
    MOST_BYTES,
    check_files,
    policies,
    read_manifest,
    write_manifest,
)
from overcooked_bench.agents.pools.records import Entry, Manifest, Training
from overcooked_bench.documents import read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.pools.profile import Measured
from overcooked_bench.files import read_regular, shown, write_whole

from ..methods import find_method
from ..running.locks import locked
from ..running.parts import checkpoints
from ..running.place import CONFIG_FILE, Place, read_record, write_record
from ..running.run import Outcome
from .config import PoolConfig, Run
from .costs import RunCost
from .groups import CLONE, EARLY, FINAL, HALF, Kind

AGENTS_FILE: Final = "agents.json"
"""A finished run's agents, in its folder: their entries, and where their policies lie."""
_SAID_ELSEWHERE: Final = ("layout", "seed", "method", "training_seed", "people")  # in the manifest's entry itself


class PoolBuildError(WrongUse):
    """A folder's content does not belong to this pool's configuration; the message says what to write instead."""


class _Kept(msgspec.Struct):
    """An agent of a run: where its policy's files are, below the run's folder, and its entry."""

    policy: str
    record: Entry


class _Agents(msgspec.Struct):
    """What `agents.json` holds; runs of earlier versions do not say what their partners cost."""

    seconds: float
    agents: list[_Kept]
    joint_steps: int | None = None
    partner_runs: int | None = None


def train_run(run: Run, folder: Path, every: int = 250_000) -> bool:
    """Trains a run, going on where it was stopped, and writes down its agents.

    Args:
        run: What to train.
        folder: Its own.
        every: Joint steps between checkpoints.

    Returns:
        Whether it is finished; False where it was stopped, and saved.
    """
    if (folder / AGENTS_FILE).exists():
        return True
    method = find_method(run.group.method)
    place = Place(folder, run.seed, resume=(folder / CONFIG_FILE).exists(), every=every)
    outcome: Outcome | None = method.train(run.settings, place)
    if outcome is None:
        return False
    resolved = read_record(folder / CONFIG_FILE, dict[str, Any]) or {}
    settings = {**resolved, "restarted": outcome.total_restarts}
    if not outcome.total_restarts:
        del settings["restarted"]
    entries = []
    for kind, (files, done, found) in _keep(run, outcome).items():
        trained = Training(
            method=run.group.method,
            seed=run.seed,
            namespace=run.pool.namespace,
            settings={key: value for key, value in settings.items() if key not in _SAID_ELSEWHERE},
            steps=done,
            self_play=found.self_play,
            configuration=run.configuration,
            checkpoint=round(done / outcome.steps, 4) if outcome.steps else 1.0,
            profile=found.profile,
            codebase=getattr(method, "CODEBASE", None),
        )
        record = Entry(
            name=run.agent(kind),
            layout=run.layout,
            reference=None,  # hashed when it enters the pool
            role="partner",
            stratum=trained.stratum,
            lineage=run.lineage,
            training=trained,
            people=run.settings.people or None,
        )
        stem = files.weights.with_suffix("").relative_to(folder).as_posix()
        entries.append(_Kept(stem, record))
    ended = _Agents(round(outcome.total_seconds, 1), entries, outcome.total_steps, outcome.partner_runs)
    write_record(folder / AGENTS_FILE, msgspec.to_builtins(ended))
    return True


def run_cost(folder: Path) -> RunCost | None:
    """Returns what a finished run cost; None if the folder holds none, or it does not say so."""
    if not (folder / AGENTS_FILE).is_file():
        return None
    found = _read_agents(folder / AGENTS_FILE)
    if found.joint_steps is None or found.partner_runs is None:
        return None
    return RunCost(found.seconds, found.joint_steps, found.partner_runs)


def _read_agents(file: Path) -> _Agents:
    try:
        return read_json(file, MOST_BYTES, _Agents, PoolBuildError)
    except PoolBuildError as error:
        raise PoolBuildError(f"{error}; remove the file, and the agents of the run are measured again") from None


def _keep(run: Run, outcome: Outcome) -> dict[Kind, tuple[PolicyFiles, int, Measured]]:
    """Chooses the agents of a run that enter the pool, with the joint steps that each has had and what it does."""
    saved, shares = checkpoints(outcome, run.settings), {FINAL: 1.0}
    for kind in {EARLY, CLONE} & set(run.group.keep):
        shares[kind] = min(outcome.snapshots)
    if HALF in run.group.keep:
        shares[HALF] = saved.half(but=shares.values())
    chosen: dict[Kind, tuple[PolicyFiles, int, Measured]] = {}
    for kind in run.group.keep:
        share = shares[kind]
        files, done = outcome.files, outcome.steps
        if share < 1:
            files, done = outcome.snapshots[share]
        chosen[kind] = files, done, saved.measured(share)
    return chosen


def publish(run: Run, folder: Path, pool: Path) -> list[Entry]:
    """Copies a finished run's agents into the pool and rewrites the manifest; safe beside other builds.

    Returns:
        The entries.

    Raises:
        PoolBuildError: The run was made under another configuration.
        PoolError: The pool that is there is damaged.
    """
    kept = _read_agents(folder / AGENTS_FILE).agents
    records = [labelled(run, one.record) for one in kept]
    for record in records:
        check_entry(run, record, f"{folder}: this run")
    if sorted(record.name for record in records) != sorted(map(run.agent, run.group.keep)):
        raise PoolBuildError(
            f"{folder}: this run kept other agents than the configuration asks for; use another --runs"
        )
    with locked(pool):
        for one, record in zip(kept, records, strict=True):
            if not Path(os.path.realpath(folder / one.policy)).is_relative_to(os.path.realpath(folder)):
                raise PoolBuildError(f"{folder / AGENTS_FILE}: {shown(one.policy)!r} is not in this folder")
            ours, theirs = policy_files(folder / one.policy), policy_files(pool / run.layout / record.name)
            for source, target in zip(ours, theirs, strict=True):
                target.parent.mkdir(exist_ok=True)
                write_whole(target, read_regular(source, MOST_BYTES, raises=PoolBuildError))
        manifest = _manifest(pool)
        known = {(entry.layout, entry.name): entry for entry in policies(manifest)} if manifest else {}
        known |= {(record.layout, record.name): record for record in records}
        beside = run.pool.scripted_entries({layout for layout, _ in known})
        write_manifest(pool, run.pool.trained, [*known.values(), *beside], cooking=run.pool.cooking)
    return records


def labelled(run: Run, record: Entry) -> Entry:
    """Returns an agent's entry with the stratum that the configuration gives."""
    return msgspec.structs.replace(record, stratum=run.group.stratum or record.stratum)


def missing(config: PoolConfig, pool: Path) -> list[Run]:
    """Lists the runs whose agents the pool does not hold yet, or with quotas the pool of their candidates.

    Raises:
        PoolBuildError: The pool is not this configuration's.
        PoolError: It is damaged.
    """
    manifest, runs, option = _manifest(pool), config.runs(), "--runs" if config.quotas else "--output"
    if manifest is None:
        return runs
    if (manifest.name, manifest.cooking, manifest.mode) != (config.trained, config.cooking, "sample"):
        raise PoolBuildError(
            f"{pool} holds the pool {manifest.name!r}, not {config.trained!r}; choose another {option}"
        )
    held = {(entry.layout, entry.name): entry for entry in policies(manifest)}
    for entry in held.values():
        check_files(pool, manifest, entry)
    beside = [entry for entry in manifest.entries if entry.training is None]
    wanted = config.scripted_entries({layout for layout, _ in held})
    if manifest.format == FORMAT and sorted(beside, key=_order) != sorted(wanted, key=_order):
        raise PoolBuildError(
            f"{pool} holds other scripted partners than the configuration names "
            f"({', '.join(sorted({entry.name for entry in beside})) or 'none'}); choose another {option}"
        )
    left, counted = [], {run.path for run in runs}
    for run in config.all_runs:
        agents = [held.pop((run.layout, run.agent(kind)), None) for kind in run.group.keep]
        for agent in filter(None, agents):
            check_entry(run, agent, f"{pool}: the agent {agent.layout}/{agent.name}")
        if None in agents and run.path in counted:
            left.append(run)
    if held:
        names = ", ".join("/".join(key) for key in sorted(held))
        raise PoolBuildError(
            f"{pool} holds agents that the configuration does not name ({names}); choose another {option}"
        )
    return left


def check_entry(run: Run, record: Entry, what: str) -> None:
    """Makes sure that an agent was trained as the configuration says."""
    if record.training is None:
        raise PoolBuildError(f"{what} does not say how it was trained; choose another --runs and --output")
    settings = json.loads(json.dumps(asdict(run.settings)))
    now = {**settings, "method": run.group.method, "seed": run.seed, "configuration": run.configuration}
    trained = record.training
    then = {**trained.settings, "method": trained.method, "seed": trained.seed, "configuration": trained.configuration}
    differing = [
        f"{key} was {value!r}, is {now[key]!r}"
        for key, value in then.items()
        if value is not None and value != now.get(key, value)
    ]
    if differing:
        raise PoolBuildError(
            f"{what} was made under another configuration ({', '.join(differing)}); choose another --runs and --output"
        )


def _manifest(pool: Path) -> Manifest | None:
    return read_manifest(pool) if (pool / MANIFEST).is_file() else None


def _order(entry: Entry) -> tuple[str, str]:
    return entry.layout, entry.name
