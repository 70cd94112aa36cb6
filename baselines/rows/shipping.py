"""The folder of an entry that ships, from the pool of the runs that are finished."""

from pathlib import Path

from overcooked_bench.agents.policies.policy import policy_files
from overcooked_bench.agents.pools.manifest import MANIFEST, MOST_BYTES, policies, read_manifest, write_manifest
from overcooked_bench.files import read_regular, write_whole

from ..building.build import PoolBuildError, run_cost
from ..building.config import PoolConfig
from ..building.costs import RunCost, read_costs, write_costs
from ..running.locks import locked


def take_over(config: PoolConfig, shipped: Path, pool: Path) -> None:
    """Copies the runs that an entry ships already into the pool of finished runs, so that none is trained again.

    Args:
        config: The entry's.
        shipped: Its folder; may be missing.
        pool: The pool of finished runs; left as it is if there is one.
    """
    if not (shipped / MANIFEST).is_file() or (pool / MANIFEST).is_file():
        return
    manifest = read_manifest(shipped)
    _copy([(entry.layout, entry.name) for entry in policies(manifest)], shipped, pool)
    write_manifest(pool, config.name, manifest.entries, cooking=manifest.cooking)
    write_costs(pool, read_costs(shipped))


def whole_seeds(config: PoolConfig, pool: Path) -> int:
    """Returns the number of training seeds, from the first one on, that are finished on every layout."""
    if not (pool / MANIFEST).is_file():
        return 0
    held = {(entry.layout, entry.name) for entry in policies(read_manifest(pool))}
    runs = config.runs()
    indices = range(max(run.index for run in runs) + 1)
    whole = (all((run.layout, run.name) in held for run in runs if run.index == index) for index in indices)
    return next((index for index, there in enumerate(whole) if not there), len(indices))


def ship(config: PoolConfig, home: Path, pool: Path, target: Path) -> int:
    """Writes an entry's folder, with the training seeds that are finished on every layout.

    Every finished run counts, whatever it reached. A seed that is missing on a layout holds back those after it, so
    that no choice is made among them.

    Args:
        config: The entry's.
        home: Folder of its training runs.
        pool: The pool of those that are finished.
        target: The entry's folder.

    Returns:
        The number of training seeds; the folder is left as it is if it has as many.

    Raises:
        PoolBuildError: The folder holds more training seeds than are finished here.
        PoolError: What is there is damaged.
    """
    seeds = whole_seeds(config, pool)
    there = whole_seeds(config, target)
    if there > seeds:
        raise PoolBuildError(
            f"{target} has {there} training seeds, and {seeds} are finished in {pool}; give another --runs"
        )
    if there == seeds:
        return seeds
    names = {(run.layout, run.name) for run in config.runs() if run.index < seeds}
    with locked(target):
        _copy(sorted(names), pool, target)
        kept = [entry for entry in policies(read_manifest(pool)) if (entry.layout, entry.name) in names]
        write_manifest(target, config.name, kept, cooking=config.cooking)
        write_costs(target, _costs(config, home, pool, seeds))
    return seeds


def _costs(config: PoolConfig, home: Path, pool: Path, seeds: int) -> dict[str, RunCost]:
    """Returns what the first training seeds cost: those that were taken over, and those that were trained here."""
    taken, found = read_costs(pool), dict[str, RunCost]()
    for run in config.runs():
        name = f"{run.layout}/{run.name}"
        cost = run_cost(home / run.path) or taken.get(name)
        if cost is not None and run.index < seeds:
            found[name] = cost
    return found


def _copy(names: list[tuple[str, str]], source: Path, target: Path) -> None:
    for layout, name in names:
        for ours, theirs in zip(
            policy_files(source / layout / name), policy_files(target / layout / name), strict=True
        ):
            theirs.parent.mkdir(parents=True, exist_ok=True)
            write_whole(theirs, read_regular(ours, MOST_BYTES, raises=PoolBuildError))
