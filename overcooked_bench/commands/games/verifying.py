"""`overcooked-bench games verify`: whether recorded games replay as their file says."""

import argparse
from typing import Any

from overcooked_bench.commands.common import ProgressBar, add_command, add_json, print_json


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
        for fault in faults:
            print(fault)
        verdict = f"not sound, {len(faults)} lines deviate" if faults else "sound"
        print(f"{options.file}: {verdict}; {len(games):,} games replayed, {steps:,} steps, {soups:,} soups")
    return 1 if faults else 0
