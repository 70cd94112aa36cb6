"""Holds human proxies against the people they were made from, and writes `results/human.md` with its pictures.

    python -m overcooked_bench.baselines.human_report --games runs/human/2019.games.jsonl

What follows the line `KEPT` in the file is written by hand, and stays as it is when the file is written again.
"""

import argparse
import json
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import write_whole
from overcooked_bench.human.games import read_games
from overcooked_bench.human.people import SETS, chosen

from .by_hand import with_part_by_hand
from .cloning.sweep import FOUND
from .human_proxy import GAMES, games_digest
from .likeness.crowds import Length
from .likeness.likeness import Likeness, likenesses
from .likeness.pictures import draw_soups, draw_visits
from .likeness.proxies import proxies_of
from .likeness.written import SOUPS_PICTURE, VISITS_PICTURE, written

POOLS: Final = ("human-train", "human-test")
REPORT: Final = "human.md"
TRIES: Final = "human-sweep.json"
"""What was tried to choose the coefficient; written from the folder of `cloning.sweep`, read where none is given."""


def judged(games_file: str, pools: Sequence[str], length: Length) -> list[Likeness]:
    """Judges all proxies of some pools, layout by layout and set by set.

    Args:
        games_file: Games of people of both sets.
        pools: Names or folders.
        length: How much agents play.

    Raises:
        GamesError: The games file is missing, or a game does not replay.
        PoolError: A pool is missing or damaged.
        WrongUse: A pool was made from other games, or none holds a human proxy.
    """
    digest = games_digest(games_file)
    recorded = read_games(games_file)
    games = [game for pairs in SETS for game in chosen(recorded, pairs)]
    loaded = [Pool.load(pool) for pool in pools]
    found: list[Likeness] = []
    for layout in dict.fromkeys(layout for pool in loaded for layout in pool.layouts):
        proxies = [proxy for pool in loaded for proxy in proxies_of(pool, layout, digest)]
        if proxies:
            print(layout, file=sys.stderr, flush=True)
            found += likenesses([game for game in games if game.layout == layout], layout, proxies, length)
    if not found:
        raise WrongUse(f"no human proxy in {', '.join(pools)}; give pools of the method human-proxy")
    return found


def read_tries(folder: Path | None, output: Path) -> list[dict[str, Any]]:
    """Returns what `cloning.sweep` tried: from its folder, else from the file of an earlier report, else nothing."""
    if folder is not None:
        return [json.loads(file.read_text()) for file in sorted(folder.glob(f"*/{FOUND}"))]
    known = output / TRIES
    return list(json.loads(known.read_text())) if known.exists() else []


def main(arguments: Sequence[str] | None = None) -> int:
    """Writes the report and its pictures; gives the exit code, 2 for wrong use."""
    parser = argparse.ArgumentParser(prog="human_report", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--games", default=GAMES, help=f"games file of people (default: {GAMES})")
    parser.add_argument(
        "--pools", nargs="+", default=list(POOLS), help=f"names or folders (default: {' '.join(POOLS)})"
    )
    parser.add_argument("--sweep", type=Path, metavar="FOLDER", help="what `cloning.sweep` wrote")
    parser.add_argument("--output", type=Path, default=Path("baselines/results"), help="folder to write to")
    parser.add_argument("--episodes", type=int, default=Length().episodes, help="games of each pairing of agents")
    parser.add_argument("--horizon", type=int, default=Length().horizon, help="steps of each")
    given = parser.parse_args(arguments)
    try:
        found = judged(given.games, given.pools, Length(given.episodes, given.horizon))
    except WrongUse as error:
        print(error, file=sys.stderr)
        return 2
    output, tries = given.output, read_tries(given.sweep, given.output)
    output.mkdir(parents=True, exist_ok=True)
    report = output / REPORT
    write_whole(report, with_part_by_hand(report, written(found, tries)))
    write_whole(output / SOUPS_PICTURE, draw_soups(found))
    write_whole(output / VISITS_PICTURE, draw_visits(found))
    if given.sweep is not None:
        write_whole(output / TRIES, (json.dumps(tries, indent=1) + "\n").encode())
    print(report)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
