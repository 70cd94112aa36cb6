"""`overcooked-bench games`: recorded games of people and agents."""

from typing import Any

from overcooked_bench.commands.common import add_group
from overcooked_bench.commands.games.answering import add_answers
from overcooked_bench.commands.games.exporting import add_export
from overcooked_bench.commands.games.importing import add_import_2019
from overcooked_bench.commands.games.showing import add_show
from overcooked_bench.commands.games.stats import add_stats
from overcooked_bench.commands.games.verifying import add_verify


def add_games(commands: Any) -> None:
    """Declares the group."""
    inner = add_group(
        commands,
        "games",
        "get, list, check, describe and export recorded games",
        "overcooked-bench games show me.games.jsonl",
    )
    for add in (add_import_2019, add_show, add_verify, add_stats, add_export, add_answers):
        add(inner)
