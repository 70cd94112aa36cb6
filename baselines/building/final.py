"""The pool that was chosen: how it is written, and how one sees that a pool's folder holds it."""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

from overcooked_bench.agents.policies.policy import policy_files
from overcooked_bench.agents.pools.manifest import (
    MANIFEST,
    MOST_BYTES,
    check_files,
    policies,
    read_manifest,
    write_manifest,
)
from overcooked_bench.agents.pools.records import Entry, Manifest
from overcooked_bench.files import read_regular, write_whole

from ..running.locks import locked
from .build import PoolBuildError, check_entry
from .config import PoolConfig


def write_chosen(config: PoolConfig, source: Path, pool: Path, entries: Sequence[Entry]) -> Manifest:
    """Copies the chosen candidates into the pool and writes its manifest, as a release candidate.

    Policies of an earlier choice that are not in the pool any more are removed.

    Args:
        config: The pool.
        source: The pool of candidates.
        pool: Its folder.
        entries: All of its entries.

    Raises:
        PoolBuildError: The folder holds another pool, or a frozen one that differs.
        PoolError: What is there is damaged.
    """
    with locked(pool):
        before = read_manifest(pool) if (pool / MANIFEST).is_file() else None
        if before is not None and before.name != config.name:
            raise PoolBuildError(f"{pool} holds the pool {before.name!r}, not {config.name!r}; choose another --output")
        chosen = sorted(entries, key=lambda entry: (entry.layout, entry.name))
        if before is not None and list(before.entries) == chosen:
            return before
        if before is not None and before.frozen:
            raise PoolBuildError(f"{pool} is frozen, and other partners were chosen now; choose another --output")
        for entry in chosen:
            if entry.training is not None:
                stem = Path(entry.layout) / entry.name
                for ours, theirs in zip(policy_files(source / stem), policy_files(pool / stem), strict=True):
                    theirs.parent.mkdir(exist_ok=True)
                    write_whole(theirs, read_regular(ours, MOST_BYTES, raises=PoolBuildError))
        manifest = write_manifest(pool, config.name, chosen, cooking=config.cooking, frozen=False)
        kept = {(entry.layout, entry.name) for entry in chosen}
        for entry in policies(before) if before is not None else ():
            if (entry.layout, entry.name) not in kept:
                for file in policy_files(pool / entry.layout / entry.name):
                    file.unlink(missing_ok=True)
    return manifest


def is_complete(config: PoolConfig, pool: Path) -> bool:
    """Returns whether a folder holds a pool that was chosen as the configuration says: nothing is left to train.

    Raises:
        PoolBuildError: It holds another pool, or one that was trained under another configuration.
        PoolError: It is damaged.
    """
    if not (pool / MANIFEST).is_file():
        return False
    manifest = read_manifest(pool)
    if manifest.name != config.name:
        raise PoolBuildError(f"{pool} holds the pool {manifest.name!r}, not {config.name!r}; choose another --output")
    runs = {(run.layout, run.name): run for run in config.all_runs}
    scripted = {one.name: one for one in config.scripted}
    found: Counter[tuple[str, str]] = Counter()
    for entry in manifest.entries:
        if entry.training is None and entry.name in scripted:
            found[entry.layout, scripted[entry.name].quota] += 1
        elif (run := runs.get((entry.layout, entry.name))) is not None:
            check_files(pool, manifest, entry)
            check_entry(run, entry, f"{pool}: the agent {entry.layout}/{entry.name}")
            found[entry.layout, run.group.quota] += 1
        else:
            return False
    floors = sum(not one.quota for one in config.scripted)
    wanted = Counter({(layout, quota): n for layout in config.layouts for quota, n in config.quotas_on(layout).items()})
    return found == wanted + Counter({(layout, ""): floors for layout in config.layouts})
