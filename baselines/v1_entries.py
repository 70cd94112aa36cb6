"""Scores every shipped entry with v1, and writes `results/v1-entries.md`, its numbers, and the table of the README.

    python -m overcooked_bench.baselines.v1_entries --workers 2 --readme README.md --board baselines/board

What was played stays in `--played`, and is not played again: after a stop, the same command goes on. With `--numbers`
the page is written again from its JSON file. What follows the line `KEPT` in the page is written by hand, and stays.
"""

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.agents.entries import shipped_entries
from overcooked_bench.documents import read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import write_whole

from .by_hand import with_part_by_hand
from .rows.board import write_row
from .rows.gathered import gather
from .rows.playing import Games, PlayedEntry, play_entry
from .rows.records import SCHEMA, Standings
from .rows.written import readme_table, written

REFERENCE: Final = "greedy"
BEGIN: Final = "<!-- Written by v1_entries. -->"
END: Final = "<!-- Up to here. -->"
"""The table of the README is between these lines."""
_MOST_BYTES: Final = 64_000_000
_NAME: Final = "v1-entries"


class StandingsError(WrongUse):
    """The numbers of the page cannot be read, or there is no place for the table."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Plays, and writes the page, its numbers and the README's table; gives the exit code, 2 for wrong use."""
    parser = argparse.ArgumentParser(prog="v1_entries", description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("--entries", nargs="*", default=None, metavar="NAME", help="shipped entries (default: all)")
    parser.add_argument("--protocol", default="v1", help="name or file (default: v1)")
    parser.add_argument("--thesis", default="thesis", help="protocol of ordered curves, name or file (default: thesis)")
    parser.add_argument(
        "--strangers", default="train-v1", help="pool whose self-play agents are partners under it (default: train-v1)"
    )
    parser.add_argument("--workers", type=int, default=1, help="processes (default: 1)")
    parser.add_argument(
        "--played", type=Path, default=Path(f"runs/{_NAME}"), help=f"what was played (default: runs/{_NAME})"
    )
    parser.add_argument("--output", type=Path, default=Path("baselines/results"), help="folder to write to")
    parser.add_argument("--board", type=Path, help="folder in which the rows of the leaderboard are written again, too")
    parser.add_argument("--readme", type=Path, help="a Markdown file in which the table is written again, too")
    parser.add_argument("--numbers", action="store_true", help="play nothing; write the page from its JSON file")
    given = parser.parse_args(arguments)
    numbers = given.output / f"{_NAME}.json"
    try:
        if given.numbers:
            found = read_standings(numbers)
        else:
            games = Games.of(given.protocol, given.thesis, given.strangers, given.workers)
            names = shipped_entries() if given.entries is None else given.entries
            played = _play(names, games, given.played)
            found = gather(played, games, REFERENCE)
            for one in played if given.board else ():
                write_row(one, given.played / f"{one.name}-{games.protocol.name}", given.board / one.name)
            given.output.mkdir(parents=True, exist_ok=True)
            write_whole(numbers, msgspec.json.format(msgspec.json.encode(found), indent=1) + b"\n")
        page = given.output / f"{_NAME}.md"
        write_whole(page, with_part_by_hand(page, written(found)))
        if given.readme:
            write_whole(given.readme, with_table(given.readme, found))
    except WrongUse as error:
        print(f"v1_entries: {error}", file=sys.stderr)
        return 2
    print(page)
    return 0


def read_standings(file: Path) -> Standings:
    """Reads the numbers of the page.

    Raises:
        StandingsError: The file is missing, damaged, or of another schema.
    """
    found: Standings = read_json(file, _MOST_BYTES, Standings, StandingsError)
    if found.schema != SCHEMA:
        raise StandingsError(f"{file}: its schema is {found.schema}, this version reads {SCHEMA}; play again")
    return found


def with_table(page: Path, found: Standings) -> str:
    """Returns a page's text with the table between `BEGIN` and `END` written again.

    Raises:
        StandingsError: It does not have these two lines.
    """
    before, begin, rest = page.read_text("utf-8").partition(f"{BEGIN}\n")
    _, end, after = rest.partition(END)
    if not begin or not end:
        raise StandingsError(f"{page}: no place for the table; write a line {BEGIN!r}, and {END!r} below it")
    return f"{before}{BEGIN}\n{readme_table(found).markdown()}\n{END}{after}"


def _play(names: Sequence[str], games: Games, home: Path) -> list[PlayedEntry]:
    """Plays the entries and the reference agent, one after the other."""
    everyone = [*dict.fromkeys((*names, REFERENCE))]
    played = []
    for name in everyone:
        played.append(play_entry(name, games, home, _say))
        print(f"{name}: played", file=sys.stderr)
    return played


def _say(what: str, done: int, of: int) -> None:
    if sys.stderr.isatty():
        print(f"\r\033[K{what} {done} of {of}", end="\r" if done == of else "", file=sys.stderr, flush=True)


if __name__ == "__main__":
    from overcooked_bench.baselines.v1_entries import main as imported  # worker processes find it by this name

    raise SystemExit(imported())
