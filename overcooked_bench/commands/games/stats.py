"""`overcooked-bench games stats`: what chefs do in recorded games."""

import argparse
from typing import Any

from overcooked_bench.commands.common import (
    ProgressBar,
    add_command,
    add_json,
    add_layouts,
    add_output,
    console,
    print_json,
)
from overcooked_bench.commands.games.choosing import check_layouts


def add_stats(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "stats",
        _stats,
        "describe what chefs do: soups, idle share, events, hand-overs, walking direction, and where they stand",
        "overcooked-bench games stats me.games.jsonl --layouts coordination_ring,counter_circuit",
    )
    parser.add_argument("file", metavar="FILE", help="a games file (*.games.jsonl)")
    add_layouts(parser)
    add_output(parser, "<FILE>-stats, next to it")
    add_json(parser)


def _stats(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.errors import WrongUse
    from overcooked_bench.files import write_whole
    from overcooked_bench.human.conduct import as_json, conducts
    from overcooked_bench.human.games import SUFFIX, read_games
    from overcooked_bench.human.heatmap import draw_conduct
    from overcooked_bench.human.shown import conduct_tables

    file = Path(options.file)
    with ProgressBar("replaying") as tell:
        games = read_games(file)
        check_layouts(file, options.layouts, (game.layout for game in games))
        if not games:
            raise WrongUse(f"{file}: no games in it; give a file with one game per line")
        wanted = options.layouts
        found = conducts([game for game in games if wanted is None or game.layout in wanted], on_progress=tell)
    folder = Path(options.output) if options.output else file.with_name(f"{file.name.removesuffix(SUFFIX)}-stats")
    folder.mkdir(parents=True, exist_ok=True)
    draw_conduct(found, folder / "visits.png")
    write_whole(folder / "stats.json", as_json(found))
    if options.json:
        print_json(found)
        return 0
    shown = console()
    shown.print(conduct_tables(found))
    for name in ("visits.png", "stats.json"):
        shown.print(str(folder / name), highlight=False, markup=False, style="dim")
    return 0
