"""`overcooked-bench games export`: the episodes of a score as a games file."""

import argparse
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from overcooked_bench.commands.common import ProgressBar, add_command, add_layouts, add_output
from overcooked_bench.commands.games.choosing import check_layouts, counted

if TYPE_CHECKING:
    from overcooked_bench.human.game import Game

_NAME = "episodes.games.jsonl"


def add_export(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "export",
        _export,
        "write the episodes of a score to a games file",
        "overcooked-bench games export scores/greedy-v1 --layouts cramped_room",
    )
    parser.add_argument("score", metavar="DIR", help="the folder of a score, or its episodes.sqlite")
    add_layouts(parser)
    add_output(parser, f"the folder of the score; the file in it is {_NAME}")


def _export(options: argparse.Namespace) -> int:
    from overcooked_bench.evaluation.scores import EPISODES_FILE, in_folder
    from overcooked_bench.human.games import write_games

    with ProgressBar("reading") as tell:
        games = exported(options.score, options.layouts, lambda done, of: tell("replaying", done, of))
    file = Path(options.output or in_folder(options.score, EPISODES_FILE).parent) / _NAME
    file.parent.mkdir(parents=True, exist_ok=True)
    write_games(file, games)
    print(f"{file}  {counted(len(games), 'game')}, {counted(sum(game.steps for game in games), 'step')}")
    return 0


def exported(
    source: str | Path,
    layouts: Sequence[str] | None = None,
    on_progress: Callable[[int, int], object] = lambda done, of: None,
) -> "list[Game]":
    """Reads the episodes of a score as games, in the order of layout, training seed, start state, partner and seat.

    Args:
        source: The folder of the score, or its episodes.sqlite.
        layouts: Only these; all by default.
        on_progress: Called with the steps that have been replayed and all there are.

    Raises:
        StoreError: There is no such score, or its episodes do not replay as they were stored.
        WrongUse: A layout that was not played.
    """
    import json

    from overcooked_bench.evaluation.games.replayed import check_returns, read_settings
    from overcooked_bench.evaluation.games.store import Store
    from overcooked_bench.evaluation.scores import EPISODES_FILE, in_folder
    from overcooked_bench.human.game import Game, Player, letters_of
    from overcooked_bench.human.games import record_all

    file = in_folder(source, EPISODES_FILE)
    with Store(file) as store:
        protocol = read_settings(store)
        rules = protocol.play
        check_layouts(file, layouts, store.values("layout"))
        check_returns(store, rules.cooking, rules.horizon)
        scored = Player("agent", store.facts.get("agent_name", "the scored agent"), store.facts.get("agent"))
        drafts = []
        for one in store.episodes():
            if layouts is not None and one.layout not in layouts:
                continue
            partner = Player("agent", one.partner, one.partner_sha256)
            drafts.append(
                Game(
                    layout=one.layout,
                    cooking=rules.cooking,
                    horizon=rules.horizon,
                    start=json.loads(one.start),
                    actions=letters_of(one.joint_actions(rules.horizon)),
                    seats=(scored, partner) if one.seat == 0 else (partner, scored),
                    soups=(),
                    source=f"score of {scored.name}, protocol {protocol.name} ({protocol.sha256[:8]})",
                    notes=one.cell,
                )
            )
    return record_all(drafts, on_progress)
