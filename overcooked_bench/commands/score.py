"""`overcooked-bench score`: plays an agent with every partner of a pool."""

import argparse
import sys
from typing import TYPE_CHECKING, Any

from overcooked_bench.commands.common import (
    ProgressBar,
    add_act_timeout,
    add_command,
    add_engine,
    add_isolate,
    add_json,
    add_layouts,
    add_output,
    add_seed,
    add_workers,
    console,
)

if TYPE_CHECKING:
    from overcooked_bench.evaluation.playing import Progress
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
        help="a name that `overcooked-bench list` shows, a Python file with make_agent, a folder with agent.py, or "
        "what `submission pack` wrote",
    )
    parser.add_argument(
        "--protocol",
        metavar="NAME|FILE",
        help="which layouts, pool and episodes are played (default: the newest shipped protocol)",
    )
    parser.add_argument("--pool", metavar="NAME|FOLDER", help="play with this pool instead of the protocol's")
    parser.add_argument(
        "--start",
        choices=("random", "standard"),
        help="start states: random ones, or the layout's own (default: the protocol's); scores of another start are of "
        "other games",
    )
    add_layouts(parser, "play only these layouts of the protocol; an overall score needs all of them")
    add_output(parser, "scores/<agent>-<protocol>")
    add_workers(parser)
    add_engine(parser)
    add_seed(parser, "change the start states and random streams; use 0 for scores that you compare or report")
    parser.add_argument(
        "--salt",
        metavar="TEXT",
        help="text that all random streams are derived from; `fresh` draws one, as official runs do, so that a "
        "submission cannot compute who its partners are (default: the protocol's public one)",
    )
    add_act_timeout(parser)
    add_isolate(parser)
    parser.add_argument(
        "--scenarios",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="also run the cooperation unit tests, which takes a few seconds (default: yes)",
    )
    parser.add_argument(
        "--explain",
        action="store_true",
        help="also show thresholds, partners, cooperation and scenarios, and explain the numbers",
    )
    add_json(parser)


def _score(options: argparse.Namespace) -> int:
    from overcooked_bench.evaluation.games.engines import default_workers
    from overcooked_bench.evaluation.playing import summary_of
    from overcooked_bench.evaluation.protocol import NEWEST, load_protocol, with_start
    from overcooked_bench.evaluation.score import score

    rules = load_protocol(options.protocol or NEWEST)
    with ProgressBar("compiling and loading") as report:
        scored = score(
            unpacked_agent(options.agent),
            protocol=rules if options.start is None else with_start(rules, options.start),
            pool=options.pool,
            layouts=options.layouts,
            output=options.output,
            workers=options.workers or default_workers(),
            engine=options.engine,
            seed=options.seed,
            salt=options.salt,
            act_timeout=options.act_timeout,
            isolate=options.isolate,
            scenarios=options.scenarios,
            on_progress=lambda at: report(*_progress(at)),
        )
    if options.json:
        print(scored.scores.to_json(), end="")
    else:
        _print_score(scored, options.explain)
    for warning in scored.scores.run.get("warnings", ()):
        print(f"overcooked-bench: warning: {warning}", file=sys.stderr)
    if scored.unwritten:
        print(f"overcooked-bench: nothing was written: {scored.unwritten}", file=sys.stderr)
    if scored.scores.faults:
        for line in summary_of(scored.scores.faults):
            print(f"overcooked-bench: {line}", file=sys.stderr)
        return 1
    return 0


def unpacked_agent(agent: str) -> str:
    """Returns the agent, or the folder next to a packed submission with its files."""
    if not agent.endswith(".submission.zip"):
        return agent
    from overcooked_bench.leaderboard.submission.archive import unpacked

    return str(unpacked(agent))


def _progress(at: "Progress") -> tuple[Any, ...]:
    """Returns what the progress bar shows: of scenarios no number of episodes."""
    if at.what == "scenarios":
        return at.what, at.done, at.of
    return f"blocks, {at.what}", at.done, at.of, at.episodes


def _print_score(scored: "Scored", explain: bool) -> None:
    from overcooked_bench.evaluation.beside import beside
    from overcooked_bench.evaluation.scores import CURVE_FILE, EPISODES_FILE, REPORT_FILE, SCENARIOS_FILE, SCORES_FILE
    from overcooked_bench.evaluation.shown.terminal import score_tables
    from overcooked_bench.rendering.table import styled

    folder, shown = scored.folder, console()
    shown.print(score_tables(scored.scores, beside(scored.scores, folder), explain, shown.width))
    lines = []
    if not scored.episodes and scored.scores.layouts:
        lines.append(f"nothing was played: every block was in {folder} already")
    for file, what in (
        (REPORT_FILE, "the report"),
        (SCORES_FILE, "the numbers"),
        (CURVE_FILE, "the ordered curve"),
        (EPISODES_FILE, "every episode"),
        (SCENARIOS_FILE, "every scenario"),
    ):
        if (folder / file).is_file() and (file != SCENARIOS_FILE or scored.scores.scenarios):
            lines.append(f"{folder / file}  {what}")
    lines.append(f"watch the worst one: overcooked-bench replay {folder} --worst")
    lines.append(f"plots and tables as files, beside other scores: overcooked-bench report {folder} [--beside SCORE]")
    for line in lines:
        shown.print(styled(line, "dim"), soft_wrap=True)
