"""Shows what the pool v1 covers and how it ranks agents, and writes `results/v1.md` with its pictures and numbers.

    python -m overcooked_bench.baselines.v1_report --twin pools/v1-twin --candidates runs/v1/candidates

What was played stays in `--played`, and is not played again. What follows the line `KEPT` in the page is written by
hand, and stays as it is when the page is written again.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.agents.entries import load_entry, shipped_entries
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import write_whole

from .by_hand import with_part_by_hand
from .evidence.pictures import draw_cross_play, draw_people, draw_predictors
from .evidence.played import PlayedPairs
from .evidence.records import Evidence
from .evidence.study import Given, evidence
from .evidence.written import CROSS_PLAY_PICTURE, PEOPLE_PICTURE, PREDICTORS_PICTURE, written

OTHERS: Final = ("human-test", "human-train", "dev-v0", "dev-v1")
"""Pools whose mean returns scores are held against."""
SOURCES: Final = ("train-v1", "dev-v1", "dev-v0", "human-train")
"""Shipped pools that entrants come from."""
EPISODES: Final = 4


def gathered(
    pool: str,
    twin: str | None,
    candidates: Sequence[str],
    entries: Sequence[str],
    layouts: Sequence[str] | None,
    played: PlayedPairs,
) -> Evidence:
    """Plays what is missing, and gathers the evidence.

    Args:
        pool: Name or folder of the pool.
        twin: Folder of its twin; None without one.
        candidates: Folders of further pools that entrants come from, such as the candidates that were not chosen.
        entries: Names of shipped entries.
        layouts: The pool's, all by default.
        played: Plays, and remembers.

    Raises:
        WrongUse: As `evidence`, or the pool has no such layout.
        PoolError: A pool is missing or damaged.
    """
    loaded, second = Pool.load(pool), Pool.load(twin) if twin else None
    strange = sorted(set(layouts or ()) - set(loaded.layouts))
    if strange:
        raise WrongUse(f"the pool {loaded.name} has no layout {strange[0]!r}; it has {', '.join(loaded.layouts)}")
    others = [Pool.load(name) for name in OTHERS]
    runs = {name: load_entry(name).pool for name in entries}
    sources = [*map(Pool.load, (*SOURCES, *candidates)), *([second] if second else []), *runs.values()]
    given = Given(loaded, second, {other.name: other for other in others}, sources, runs)
    return evidence(given, tuple(layouts or loaded.layouts), played)


def main(arguments: Sequence[str] | None = None) -> int:
    """Writes the page, its numbers and its pictures; gives the exit code, 2 for wrong use."""
    parser = argparse.ArgumentParser(prog="v1_report", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--pool", default="v1", help="name or folder (default: v1)")
    parser.add_argument("--twin", metavar="FOLDER", help="the pool built from the same configuration with another salt")
    parser.add_argument(
        "--candidates", nargs="*", default=[], metavar="FOLDER", help="further pools that entrants come from"
    )
    parser.add_argument("--entries", nargs="*", default=list(shipped_entries()), help="names (default: all shipped)")
    parser.add_argument("--layouts", nargs="+", help="some of the pool's (default: all)")
    parser.add_argument("--episodes", type=int, default=EPISODES, help="of each pair, from each seat (default: 4)")
    parser.add_argument("--horizon", type=int, default=400, help="steps of each (default: 400)")
    parser.add_argument("--workers", type=int, default=1, help="processes (default: 1)")
    parser.add_argument("--played", type=Path, default=Path("runs/evidence"), help="where played episodes are kept")
    parser.add_argument("--output", type=Path, default=Path("baselines/results"), help="folder to write to")
    given = parser.parse_args(arguments)
    try:
        played = PlayedPairs(given.played, given.episodes, horizon=given.horizon, workers=given.workers)
        found = gathered(given.pool, given.twin, given.candidates, given.entries, given.layouts, played)
    except WrongUse as error:
        print(error, file=sys.stderr)
        return 2
    print(_write(found, given.output))
    return 0


def _write(found: Evidence, output: Path) -> Path:
    """Writes the page and what belongs to it; returns the page."""
    output.mkdir(parents=True, exist_ok=True)
    name = found.pool.name
    page = output / f"{name}.md"
    write_whole(page, with_part_by_hand(page, written(found)))
    write_whole(output / f"{name}.json", msgspec.json.format(msgspec.json.encode(found), indent=1) + b"\n")
    for picture, draw in (
        (CROSS_PLAY_PICTURE, draw_cross_play),
        (PEOPLE_PICTURE, draw_people),
        (PREDICTORS_PICTURE, draw_predictors),
    ):
        write_whole(output / f"{name}-{picture}.png", draw(found))
    return page


if __name__ == "__main__":
    raise SystemExit(main())
