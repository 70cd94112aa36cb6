"""`overcooked-bench score`: play an agent with every partner of a pool."""

import argparse
from typing import TYPE_CHECKING, Any

from overcooked_bench.commands.common import (
    ProgressBar,
    add_act_timeout,
    add_command,
    add_engine,
    add_json,
    add_layouts,
    add_output,
    add_seed,
    add_workers,
    console,
)

if TYPE_CHECKING:
    from overcooked_bench.evaluation.score import Scored


def add_score(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "score",
        _score,
        "play an agent with every partner of a pool and say how well it cooperates",
        "overcooked-bench score my_agent.py --layouts cramped_room,counter_circuit --workers 2",
    )
    parser.add_argument(
        "agent",
        metavar="AGENT",
        help="a name that `overcooked-bench list` shows, a Python file with make_agent, or a folder with agent.py",
    )
    parser.add_argument("--protocol", metavar="NAME|FILE", help="what is played (default: the newest shipped protocol)")
    parser.add_argument("--pool", metavar="NAME|FOLDER", help="another pool than the protocol's")
    add_layouts(parser, "some of the protocol's layouts")
    add_output(parser, "scores/<agent>-<protocol>")
    add_workers(parser)
    add_engine(parser)
    add_seed(parser, "other start states; compare scores of seed 0")
    parser.add_argument(
        "--salt",
        metavar="TEXT",
        help="replaces the protocol's public salt; `fresh` draws one, as official runs do (default: the public one)",
    )
    add_act_timeout(parser)
    parser.add_argument(
        "--scenarios",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="play the cooperation scenarios, too, which takes seconds (default: yes)",
    )
    add_json(parser)


def _score(options: argparse.Namespace) -> int:
    from overcooked_bench.commands.score_card import play_scenarios
    from overcooked_bench.evaluation import score as scoring
    from overcooked_bench.evaluation.games.engines import default_workers
    from overcooked_bench.evaluation.protocol import NEWEST, load_protocol
    from overcooked_bench.scenarios.errors import ScenarioFault

    protocol, fault = load_protocol(options.protocol or NEWEST), None
    with ProgressBar("compiling and loading") as tell:
        scored = scoring.score(
            options.agent,
            protocol=protocol,
            pool=options.pool,
            layouts=options.layouts,
            output=options.output,
            workers=options.workers or default_workers(),
            engine=options.engine,
            seed=options.seed,
            salt=options.salt,
            act_timeout=options.act_timeout,
            on_progress=lambda at: tell(at.layout, at.blocks, at.of),
        )
        if options.scenarios:
            try:
                card = play_scenarios(options.agent, scored, options.layouts, on_progress=tell)
                scored = scoring.with_scenarios(scored, card) if card else scored
            except ScenarioFault as error:  # the score stands
                fault = error
    if options.json:
        print((scored.folder / scoring.SCORES_FILE).read_text("utf-8"), end="")
    else:
        _print_score(scored)
    if fault:
        raise fault
    return 0


def _print_score(scored: "Scored") -> None:
    from overcooked_bench.commands.score_card import SCENARIOS_FILE
    from overcooked_bench.evaluation import score as scoring
    from overcooked_bench.evaluation.shown.tables import score_tables

    scores, folder = scored
    shown = console()
    shown.print(score_tables(scores))
    for file, what in (
        (scoring.REPORT_FILE, "the report"),
        (scoring.SCORES_FILE, "the numbers"),
        (scoring.CURVE_FILE, "the ordered curve"),
        (scoring.EPISODES_FILE, "every episode"),
        (SCENARIOS_FILE, "every scenario"),
    ):
        if (folder / file).is_file() and (file != SCENARIOS_FILE or scores.scenarios):
            shown.print(f"{folder / file}  {what}", highlight=False, markup=False, style="dim")
    shown.print(
        f"watch the worst one: overcooked-bench replay {folder} --worst", highlight=False, markup=False, style="dim"
    )
