"""What `overcooked-bench pool build` does after parsing its arguments."""

import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

from overcooked_bench.agents.pools.manifest import PoolError

from ..running.place import CheckpointError, read_record, write_record
from .build import PoolBuildError, missing
from .candidates import CANDIDATES, needed, trained
from .config import PoolConfig, PoolConfigError, Run, load_pool_config
from .queue import LOG, Display, Result, build

NOTE: Final = "pool.json"
"""Which pool the runs of a folder are for, in the folder."""


def main(
    source: str,
    runs: str | None = None,
    output: str | None = None,
    workers: int = 1,
    layouts: Sequence[str] | None = None,
    groups: Sequence[str] | None = None,
    limit: int | None = None,
    salt: str = "",
) -> int:
    """Builds a pool as far as it is asked for.

    Args:
        source: A shipped configuration's name, or a YAML file.
        runs: Folder for the training runs; `runs/<pool>` by default.
        output: The pool's folder; `pools/<pool>` by default.
        workers: Runs side by side.
        layouts: Only these.
        groups: Only these, by prefix.
        limit: So many training runs at most.
        salt: Enters the namespace of all seeds.

    Returns:
        The exit code: 0 done, 1 a run failed, 2 wrong use.

    Raises:
        KeyboardInterrupt: Stopped by Ctrl-C; all runs are saved.
    """
    try:
        config = load_pool_config(source, salt)
        home, pool = Path(runs or f"runs/{config.name}"), Path(output or f"pools/{config.name}")
        target = home / CANDIDATES if config.quotas else pool
        _check_note(home, config)
        result, left = _train(config, home, target, workers, (layouts, groups), limit)
    except (PoolConfigError, PoolBuildError, PoolError, CheckpointError) as error:
        print(f"overcooked-bench pool build: {error}", file=sys.stderr)
        return 2
    if result.stopped:
        raise KeyboardInterrupt
    for name in result.failed:
        print(f"failed: {name}; see {home / name / LOG}", file=sys.stderr)
    print(f"{target}: {'complete' if not left else f'{left} runs are missing'}" + _selected(layouts, groups))
    return 1 if result.failed else 0


def _train(
    config: PoolConfig,
    home: Path,
    target: Path,
    workers: int,
    only: tuple[Sequence[str] | None, Sequence[str] | None],
    limit: int | None,
) -> tuple[Result, int]:
    """Trains what is missing, and further runs for quotas that have too few candidates.

    Returns:
        What became of the runs, and how many are missing still.
    """
    result, wanted = Result(), _select(config, _waiting(config, target), *only)
    write_record(home / NOTE, _note(config))
    while now := wanted[: None if limit is None else limit - len(result.finished)]:
        with Display(len(wanted)) as display:
            last = build(now, home, target, workers, display)
        result = last.after(result)
        wanted = _select(config, _waiting(config, target), *only)
        if last.stopped or last.failed or last.taken:
            break
    return result, len(wanted)


def _waiting(config: PoolConfig, target: Path) -> list[Run]:
    """Lists the runs that can be trained now."""
    runs = missing(config, target)
    return needed(config, trained(target)) if config.quotas else runs


def _note(config: PoolConfig) -> dict[str, str]:
    return {"pool": config.name, "namespace": config.namespace}


def _check_note(home: Path, config: PoolConfig) -> None:
    """Makes sure that a folder's runs are those of this pool, with this salt.

    Raises:
        PoolBuildError: They are of another pool, or another salt was given.
        CheckpointError: The note cannot be read.
    """
    found = read_record(home / NOTE, dict[str, str])
    if found is not None and found != _note(config):
        raise PoolBuildError(
            f"{home} holds runs of the pool {found.get('pool')!r} in the namespace {found.get('namespace')!r}, not of "
            f"{config.name!r} in {config.namespace!r}; give the same --salt, or choose another --runs and --output"
        )


def _select(
    config: PoolConfig, runs: list[Run], layouts: Sequence[str] | None, groups: Sequence[str] | None
) -> list[Run]:
    prefixes = [group.prefix for group in config.groups]
    for what, given, known in (("layout", layouts, config.layouts), ("group", groups, prefixes)):
        strange = sorted(set(given or ()) - set(known))
        if strange:
            raise PoolConfigError(f"pool {config.name} has no {what} {strange[0]!r}; it has {', '.join(known)}")
    return [
        run
        for run in runs
        if (layouts is None or run.layout in layouts) and (groups is None or run.group.prefix in groups)
    ]


def _selected(layouts: Sequence[str] | None, groups: Sequence[str] | None) -> str:
    chosen = ", ".join([*(layouts or ()), *(groups or ())])
    return f" ({chosen})" if chosen else ""
