"""`overcooked-bench`: parses, calls one function, prints.

Exit codes: 0 done, 1 a failed check (the scored agent broke the contract), 2 wrong use, 130 stopped by Ctrl-C or
SIGTERM.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any

from overcooked_bench.commands.common import ProgressBar, add_command, names
from overcooked_bench.commands.common import console as make_console
from overcooked_bench.commands.pool import add_pool
from overcooked_bench.commands.scenarios import add_scenarios
from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.processes import sigterm_as_ctrl_c

if TYPE_CHECKING:
    from overcooked_bench.evaluation.score import Scored

_EPILOG = "Each command has its own --help with an example."
_METHODS = (
    *("self-play", "biased-self-play", "best-response", "partner-sampling"),
    *("pretrained-partners", "pbt", "population"),
)


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command.

    Args:
        arguments: The command line without the program's name; `sys.argv` by default.

    Returns:
        The exit code.
    """
    with sigterm_as_ctrl_c():
        return _run(list(sys.argv[1:] if arguments is None else arguments))


def _run(given: list[str]) -> int:
    try:
        if given[:1] == ["train"] and len(given) > 1 and not given[1].startswith("-"):
            return _train(given[1], given[2:])
        options = _parser().parse_args(given)
        command: Callable[[argparse.Namespace], int] = options.command
        return command(options)
    except KeyboardInterrupt:
        again = " (with --resume, once its folder is there)" if given[:1] == ["train"] else ""
        print(f"\nstopped; what is finished is kept, and the same command goes on from there{again}", file=sys.stderr)
        return 130
    except BrokenPipeError:
        sys.stderr.close()
        return 0
    except (OvercookedBenchError, OSError) as error:
        print(f"overcooked-bench: {error}", file=sys.stderr)
        return getattr(error, "exit_code", OvercookedBenchError.exit_code)


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="overcooked-bench",
        description="Score agents that cooperate with strangers in Overcooked kitchens.",
        epilog=_EPILOG,
    )
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for add in (_add_score, _add_replay, _add_train, add_pool, add_scenarios, _add_list):
        add(commands)
    return parser


def _add_score(commands: Any) -> None:
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
    parser.add_argument("--layouts", metavar="A,B", type=names, help="some of the protocol's layouts")
    parser.add_argument("--output", metavar="DIR", help="where to write (default: scores/<agent>-<protocol>)")
    parser.add_argument("--workers", metavar="N", type=int, help="processes (default: the usable cores, four at most)")
    parser.add_argument("--engine", default="local", metavar="local|dask|ray", help="where the processes run")
    parser.add_argument("--seed", metavar="N", type=int, default=0, help="other start states; compare scores of seed 0")
    parser.add_argument(
        "--salt",
        metavar="TEXT",
        help="replaces the protocol's public salt; `fresh` draws one, as official runs do (default: the public one)",
    )
    parser.add_argument(
        "--scenarios",
        action=argparse.BooleanOptionalAction,
        default=True,
        help="play the cooperation scenarios, too, which takes seconds (default: yes)",
    )
    parser.add_argument("--json", action="store_true", help="print score.json in place of the table")


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
            workers=default_workers() if options.workers is None else options.workers,
            engine=options.engine,
            seed=options.seed,
            salt=options.salt,
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
    console = make_console()
    console.print(score_tables(scores))
    for file, what in (
        (scoring.REPORT_FILE, "the report"),
        (scoring.SCORES_FILE, "the numbers"),
        (scoring.CURVE_FILE, "the ordered curve"),
        (scoring.EPISODES_FILE, "every episode"),
        (SCENARIOS_FILE, "every scenario"),
    ):
        if (folder / file).is_file() and (file != SCENARIOS_FILE or scores.scenarios):
            console.print(f"{folder / file}  {what}", highlight=False, style="dim")
    console.print(f"watch the worst one: overcooked-bench replay {folder} --worst", highlight=False, style="dim")


def _add_replay(commands: Any) -> None:
    parser = add_command(
        commands,
        "replay",
        _replay,
        "show a recorded episode in the terminal or as a GIF",
        "overcooked-bench replay scores/greedy-dev --layout cramped_room --worst --gif worst.gif",
    )
    parser.add_argument("score", metavar="DIR", help="the folder of a score, or its episodes.sqlite")
    parser.add_argument("--layout", metavar="NAME", help="on this layout")
    parser.add_argument("--partner", metavar="NAME", help="with this partner")
    parser.add_argument("--seat", type=int, choices=(0, 1), help="with the scored agent on this seat")
    parser.add_argument("--episode", metavar="N", type=int, help="this start state")
    parser.add_argument("--training-seed", metavar="N", type=int, help="this training run of the agent")
    parser.add_argument("--worst", action="store_true", help="the fewest points among those that fit, not the first")
    parser.add_argument("--gif", metavar="FILE", help="write a GIF in place of showing it")
    parser.add_argument("--fps", metavar="N", type=float, default=8, help="steps a second (default: 8)")
    parser.add_argument("--every", metavar="N", type=int, default=1, help="show each N-th step alone")


def _replay(options: argparse.Namespace) -> int:
    from overcooked_bench.evaluation.games.recording import find_recording

    recording = find_recording(
        options.score,
        layout=options.layout,
        partner=options.partner,
        seat=options.seat,
        episode=options.episode,
        training_seed=options.training_seed,
        worst=options.worst,
    )
    if options.gif:
        recording.save_gif(options.gif, fps=options.fps, every=options.every)
        print(f"{options.gif}  {recording.title}")
    else:
        print(recording.title)
        recording.show(fps=options.fps, every=options.every)
    return 0


def _add_train(commands: Any) -> None:
    parser = add_command(
        commands,
        "train",
        lambda _: _train("", []),
        "train a baseline; `overcooked-bench train METHOD --help` shows the method's own options",
        "overcooked-bench train self-play --layout cramped_room --seed 0 --output runs/self-play",
    )
    parser.add_argument("method", metavar="METHOD", nargs="?", help=", ".join(_METHODS))
    parser.add_argument("options", metavar="...", nargs="*", help="passed on to the method")


def _train(method: str, rest: list[str]) -> int:
    if not method:
        print(
            f"overcooked-bench train: name a method ({', '.join(_METHODS)}), such as\n"
            "  overcooked-bench train self-play --layout cramped_room --seed 0",
            file=sys.stderr,
        )
        return 2
    if method not in _METHODS:
        print(f"overcooked-bench: no training method named {method!r}; there is {', '.join(_METHODS)}", file=sys.stderr)
        return 2
    run: Callable[[list[str]], int] = import_module(f"overcooked_bench.baselines.{method.replace('-', '_')}").main
    return run(rest)


def _add_list(commands: Any) -> None:
    parser = add_command(
        commands, "list", _list, "show layouts, agents, protocols and pools", "overcooked-bench list agents --json"
    )
    parser.add_argument("kind", nargs="?", choices=("layouts", "agents", "protocols", "pools"), help="only these")
    parser.add_argument("--json", action="store_true", help="print JSON")


def _list(options: argparse.Namespace) -> int:
    from overcooked_bench.agents.catalogue import catalogue
    from overcooked_bench.agents.pools.pool import shipped_pools
    from overcooked_bench.evaluation.protocol import protocol_names
    from overcooked_bench.kitchen.layout import layout_names

    found = {
        "layouts": list(layout_names()),
        "agents": list(catalogue()),
        "protocols": list(protocol_names()),
        "pools": list(shipped_pools()),
    }
    chosen = {kind: entries for kind, entries in found.items() if options.kind in (None, kind)}
    if options.json:
        import json

        print(json.dumps(chosen, indent=2))
        return 0
    for kind, entries in chosen.items():
        print("\n".join([kind, *(f"  {name}" for name in entries)]))
    return 0
