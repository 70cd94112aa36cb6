"""`overcooked-bench games show`: what a games file holds."""

import argparse
from typing import TYPE_CHECKING, Any

from overcooked_bench.commands.common import add_command, add_json, add_layouts, console, print_json
from overcooked_bench.commands.games.choosing import check_layouts, counted

if TYPE_CHECKING:
    from overcooked_bench.human.game import Game


def add_show(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands, "show", _show, "list the games of a file", "overcooked-bench games show me.games.jsonl"
    )
    parser.add_argument("file", metavar="FILE", help="a games file (*.games.jsonl)")
    add_layouts(parser)
    add_json(parser)


def _show(options: argparse.Namespace) -> int:
    from overcooked_bench.human.games import read_games
    from overcooked_bench.rendering.table import Column, Table

    wanted = options.layouts
    everything = read_games(options.file)
    check_layouts(options.file, wanted, (game.layout for game in everything))
    games = [(number, game) for number, game in enumerate(everything) if wanted is None or game.layout in wanted]
    if options.json:
        print_json([_facts(number, game) for number, game in games])
        return 0
    rows = [
        [str(number), game.layout, _who(game), f"{game.steps:,}", str(len(game.soups)), game.group or "", game.source]
        for number, game in games
    ]
    steps, soups = sum(game.steps for _, game in games), sum(len(game.soups) for _, game in games)
    heads: list[str | Column] = [
        *("game", Column("layout", left=True, wrap=False), Column("seats 0 and 1", left=True), "steps", "soups"),
        *(Column("people", left=True, wrap=False), Column("source", left=True)),
    ]
    console().print(Table(heads, rows, [[counted(len(games), "game"), "", "", f"{steps:,}", f"{soups:,}"]]).terminal())
    return 0


def _who(game: "Game") -> str:
    return " + ".join(player.name for player in game.seats)


def _facts(number: int, game: "Game") -> dict[str, Any]:
    """All that a game says but its actions, and how long it is."""
    import msgspec

    facts: dict[str, Any] = msgspec.to_builtins(game)
    del facts["actions"]
    return {"game": number, "steps": game.steps, **facts}
