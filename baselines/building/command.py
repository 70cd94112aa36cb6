"""What `overcooked-bench pool build` does after parsing its arguments."""

import sys
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from overcooked_bench.agents.pools.manifest import MANIFEST, PoolError
from overcooked_bench.evaluation.games.apart import EngineError

from ..running.place import CheckpointError, read_record, write_record
from .build import PoolBuildError, missing
from .candidates import CANDIDATES, Key, needed, trained
from .choosing import EFFORT, Chooser, Chosen
from .config import PoolConfig, PoolConfigError, Run, load_pool_config
from .final import is_complete, write_chosen
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
    engine: str = "local",
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
        engine: Where candidates are measured: "local", "dask" or "ray".

    Returns:
        The exit code: 0 done, 1 a run failed, 2 wrong use.

    Raises:
        KeyboardInterrupt: Stopped by Ctrl-C; all runs are saved.
    """
    try:
        config = load_pool_config(source, salt)
        home, pool = Path(runs or f"runs/{config.name}"), Path(output or f"pools/{config.name}")
        job = _Job(config, home, pool, workers, layouts, groups, limit, engine)
        _check_note(home, config)
        result, left = job.chosen() if config.quotas else job.train()
    except (PoolConfigError, PoolBuildError, PoolError, CheckpointError, EngineError) as error:
        print(f"overcooked-bench pool build: {error}", file=sys.stderr)
        return 2
    if result.stopped:
        raise KeyboardInterrupt
    for name in result.failed:
        print(f"failed: {name}; see {home / name / LOG}", file=sys.stderr)
    where = pool if job.is_whole else job.target
    print(f"{where}: {'complete' if not left else f'{left} runs are missing'}" + _selected(layouts, groups))
    return 1 if result.failed else 0


@dataclass(frozen=True)
class _Job:
    """What is asked for; the arguments of `main`."""

    config: PoolConfig
    home: Path
    pool: Path
    workers: int
    layouts: Sequence[str] | None
    groups: Sequence[str] | None
    limit: int | None
    engine: str

    @property
    def target(self) -> Path:
        """The folder of the pool that finished runs enter."""
        return self.home / CANDIDATES if self.config.quotas else self.pool

    @property
    def is_whole(self) -> bool:
        """Whether the pool itself is asked for: all runs of all layouts, or what a pool without quotas lacks."""
        return not self.config.quotas or (self.layouts, self.groups, self.limit) == (None, None, None)

    def train(self, out: Collection[Key] = ()) -> tuple[Result, int]:
        """Trains what is missing, and further runs for quotas that have too few candidates.

        Args:
            out: Candidates that are left out.

        Returns:
            What became of the runs, and how many are missing still.
        """
        result, wanted = Result(), self._waiting(out)
        if wanted:
            self.home.mkdir(parents=True, exist_ok=True)
            write_record(self.home / NOTE, _note(self.config))
        while now := wanted[: None if self.limit is None else self.limit - len(result.finished)]:
            with Display(len(wanted)) as display:
                last = build(now, self.home, self.target, self.workers, display)
            result, wanted = last.after(result), self._waiting(out)
            if not last.well:
                break
        return result, len(wanted)

    def chosen(self) -> tuple[Result, int]:
        """Trains candidates, and chooses the pool among them.

        Returns:
            As `train`.
        """
        if not (self.target / MANIFEST).is_file() and is_complete(self.config, self.pool):
            return Result(), 0
        out: set[Key] = set()
        found: dict[str, Chosen] = {}
        places = [layout for layout in self.config.layouts if self.layouts is None or layout in self.layouts]
        while len(found) < len(places):
            result, left = self.train(out)
            if left or not result.well or self.groups is not None or self.limit is not None:
                return result, left
            with Display(0) as display:
                found |= self._choose([layout for layout in places if layout not in found], out, display.say)
        if self.is_whole:
            entries = [entry for one in found.values() for entry in one.entries]
            write_chosen(self.config, self.target, self.pool, entries)
        return result, left

    def _choose(self, layouts: Sequence[str], out: set[Key], say: Callable[[str], None]) -> dict[str, Chosen]:
        """Chooses the partners of some layouts; where candidates turn out to be weak, they are added to `out` instead.

        Returns:
            Layout -> its partners.
        """
        chooser = Chooser(self.config, self.home, self.workers, say, EFFORT, self.engine)
        held = trained(self.config, self.target)
        found = {}
        for layout in layouts:
            one = chooser.choose(layout, held, out)
            for name in one.weak:
                say(f"{layout} {name}: left out, too little can be reached with it")
            for sentence in one.unmet:
                say(f"{layout}: {sentence}")
            out |= {(layout, name) for name in one.weak}
            if not one.weak:
                found[layout] = one
        return found

    def _waiting(self, out: Collection[Key]) -> list[Run]:
        """Lists the runs that can be trained now."""
        runs = missing(self.config, self.target)
        if self.config.quotas:
            runs = needed(self.config, trained(self.config, self.target), out, self.layouts)
        return _select(self.config, runs, self.layouts, self.groups)


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
