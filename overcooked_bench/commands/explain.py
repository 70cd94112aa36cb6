"""`overcooked-bench explain`: say why an agent failed with its partners."""

import argparse
from typing import TYPE_CHECKING, Any, Final

from overcooked_bench.commands.common import (
    ProgressBar,
    add_act_timeout,
    add_command,
    add_isolate,
    add_json,
    add_layouts,
    add_workers,
    console,
)

if TYPE_CHECKING:
    from pathlib import Path

    from overcooked_bench.evaluation.explaining.records import Explanation

GAMES_FILE: Final = "moments.games.jsonl"


def add_explain(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "explain",
        _explain,
        "say why an agent failed: play on from its moments with its partner, with a copy of itself, and without it",
        "overcooked-bench explain scores/my_agent-v1 --agent my_agent.py --layouts forced_coordination",
    )
    parser.add_argument("score", metavar="DIR", help="the folder of a score, or its episodes.sqlite")
    parser.add_argument(
        "--agent",
        metavar="AGENT",
        help="the agent that was scored, as `score` takes it (default: what the score says, a submission aside)",
    )
    parser.add_argument(
        "--pool", metavar="NAME|FOLDER", help="the pool that it was scored with (default: what the score says)"
    )
    add_layouts(parser, "only these layouts of the score")
    add_workers(parser)
    add_act_timeout(parser)
    add_isolate(parser)
    add_json(parser)


def _explain(options: argparse.Namespace) -> int:
    from overcooked_bench.evaluation.explaining.explain import explain
    from overcooked_bench.evaluation.explaining.records import EXPLAIN_FILE, MOMENTS_FOLDER
    from overcooked_bench.evaluation.games.engines import default_workers
    from overcooked_bench.evaluation.scores import REPORT_FILE, SCORES_FILE, read_scores
    from overcooked_bench.evaluation.shown.explanation import explanation_tables
    from overcooked_bench.evaluation.shown.report import write_report
    from overcooked_bench.rendering.table import styled

    with ProgressBar("compiling and loading") as tell:
        explanation, folder = explain(
            options.score,
            agent=options.agent,
            pool=options.pool,
            layouts=options.layouts,
            workers=options.workers or default_workers(),
            act_timeout=options.act_timeout,
            isolate=options.isolate,
            on_progress=tell,
        )
    if reported := (folder / SCORES_FILE).is_file():
        write_report(read_scores(folder), folder)
    kept = folder / MOMENTS_FOLDER
    shown = console()
    games = _write_games(explanation, kept / GAMES_FILE)
    if options.json:
        print(explanation.to_json(), end="")
        return 0
    shown.print(explanation_tables(explanation))
    lines = [f"{folder / EXPLAIN_FILE}  every moment"]
    lines += [f"{folder / REPORT_FILE}  the report, which shows this too"] * reported
    if games:
        lines += [
            f"{kept}  the worst moments as scenarios: overcooked-bench scenarios run {kept} --agent AGENT",
            f"watch one, four games each: overcooked-bench replay {kept / GAMES_FILE} --game 0",
        ]
    for line in lines:
        shown.print(styled(line, "dim"), soft_wrap=True)
    return 0


def _write_games(explanation: "Explanation", file: "Path") -> int:
    """Writes the games of the worst moments as a games file, in the order of the moments and of the pairings."""
    from overcooked_bench.evaluation.explaining.reasons import PAIRINGS
    from overcooked_bench.human.game import Game, Player
    from overcooked_bench.human.games import record_all, write_games

    drafts = []
    for layout in explanation.layouts:
        for worst in layout.worst:
            moment = layout.moments[worst.moment]
            agent = Player("agent", explanation.agent.name, explanation.agent.sha256)
            partner, greedy = Player("agent", moment.partner), Player("agent", "greedy")
            pair = (agent, partner) if moment.seat == 0 else (partner, agent)
            seats = dict(zip(PAIRINGS, (pair, (agent,) * 2, (partner,) * 2, (greedy,) * 2), strict=True))
            drafts += [
                Game(
                    layout=layout.layout,
                    cooking=explanation.cooking,
                    horizon=explanation.steps,
                    start={**worst.state, "timestep": 0},
                    actions=worst.games[pairing].actions,
                    seats=seats[pairing],
                    soups=(),
                    source=f"explanation of a score of {explanation.agent.name}",
                    notes=f"{worst.name}, {pairing}, from step {moment.step}",
                )
                for pairing in PAIRINGS
            ]
    write_games(file, record_all(drafts))
    return len(drafts)
