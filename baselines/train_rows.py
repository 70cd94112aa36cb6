"""Trains the entries of a recipe and writes the folders that ship.

    python -m overcooked_bench.baselines.train_rows v1 --workers 2

One training seed of each entry comes after the other, so that entries have equal numbers of them wherever training is
stopped. Ctrl-C saves all runs, and the same command goes on; what is finished is in `--output` after every stop.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from overcooked_bench.errors import WrongUse

from .building.build import missing
from .building.config import PoolConfig
from .building.queue import LOG, Display, Result, build
from .rows.recipe import in_turn, load_recipe
from .rows.shipping import ship, take_over


def main(arguments: Sequence[str] | None = None) -> int:
    """Trains what is missing; gives the exit code: 0 done, 1 a run failed, 2 wrong use, 130 stopped."""
    parser = argparse.ArgumentParser(prog="train_rows", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("recipe", metavar="RECIPE", help="a shipped recipe's name, or a YAML file")
    parser.add_argument("--rows", nargs="+", metavar="NAME", help="only these entries (default: all)")
    parser.add_argument("--seeds", type=int, metavar="N", help="only the first N training seeds of each (default: all)")
    parser.add_argument("--workers", type=int, default=1, help="runs side by side (default: 1)")
    parser.add_argument("--runs", type=Path, default=Path("runs/rows"), help="folder of the runs (default: runs/rows)")
    parser.add_argument("--output", type=Path, default=Path("baselines/entries"), help="folder of the entries' folders")
    given = parser.parse_args(arguments)
    try:
        entries = _chosen(load_recipe(given.recipe), given.rows)
        result = train(entries, given.runs, given.output, given.workers, given.seeds)
    except WrongUse as error:
        print(f"train_rows: {error}", file=sys.stderr)
        return 2
    for name in result.failed:
        print(f"failed: {name}; see {given.runs / name / LOG}", file=sys.stderr)
    if result.stopped:
        return 130
    return 1 if result.failed or result.taken else 0


def train(entries: list[PoolConfig], home: Path, output: Path, workers: int, seeds: int | None = None) -> Result:
    """Trains the runs that are missing, and ships what is finished.

    Args:
        entries: Their configurations.
        home: Folder for the training runs, and for the pools of those that are finished.
        output: Folder for the entries' folders.
        workers: Runs side by side.
        seeds: Only so many training seeds of each, the first ones; all by default.

    Raises:
        PoolBuildError: A folder holds what was trained under another configuration.
        PoolError: What is there is damaged.
    """
    pools = {entry.name: home / "finished" / entry.name for entry in entries}
    left = set()
    for entry in entries:
        take_over(entry, output / entry.name, pools[entry.name])
        left |= {(run.pool.name, run.path) for run in missing(entry, pools[entry.name])}
    wanted = [run for run in in_turn(entries) if (run.pool.name, run.path) in left]
    if seeds is not None:
        wanted = [run for run in wanted if run.index < seeds]
    with Display(len(wanted)) as display:
        result = build(wanted, home, lambda run: pools[run.pool.name], workers, display)
    for entry in entries:
        done = ship(entry, home, pools[entry.name], output / entry.name)
        print(f"{output / entry.name}: {done} of {entry.groups[0].most} training seeds")
    return result


def _chosen(entries: list[PoolConfig], names: Sequence[str] | None) -> list[PoolConfig]:
    known = [entry.name for entry in entries]
    strange = [name for name in names or () if name not in known]
    if strange:
        raise WrongUse(f"the recipe has no row {strange[0]!r}; it has {', '.join(known)}")
    return [entry for entry in entries if names is None or entry.name in names]


if __name__ == "__main__":
    from overcooked_bench.baselines.train_rows import main as imported  # worker processes find it by this name

    raise SystemExit(imported())
