"""`overcooked-bench games verify`: whether recorded games replay as their file says."""

import argparse
from typing import Any, Final

from overcooked_bench.commands.common import ProgressBar, add_command, add_json, print_json
from overcooked_bench.commands.games.choosing import counted

_SHOWN: Final = 20  # faults; a file of another kind has one per line


def add_verify(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "verify",
        _verify,
        "replay every game of a file; exits with 1 if one does not go as the file says",
        "overcooked-bench games verify me.games.jsonl",
    )
    parser.add_argument("file", metavar="FILE", help="a games file (*.games.jsonl)")
    add_json(parser)


def _verify(options: argparse.Namespace) -> int:
    from overcooked_bench.human.games import check_games

    with ProgressBar("reading") as tell:
        games, faults = check_games(options.file, lambda done, of: tell("replaying", done, of))
    steps, soups = sum(game.steps for game in games), sum(len(game.soups) for game in games)
    if options.json:
        print_json({"sound": not faults, "games": len(games), "steps": steps, "soups": soups, "faults": faults})
    else:
        for fault in faults[:_SHOWN]:
            print(fault)
        if len(faults) > _SHOWN:
            print(f"... and {len(faults) - _SHOWN} more, which --json lists")
        verdict = f"not sound, {counted(len(faults), 'fault')}" if faults else "sound"
        what = ", ".join((f"{counted(len(games), 'game')} replayed", counted(steps, "step"), counted(soups, "soup")))
        print(f"{options.file}: {verdict}; {what}")
    return 1 if faults else 0
