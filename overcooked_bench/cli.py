"""`overcooked-bench`: parses, calls one function, prints.

Exit codes: 0 done, 1 a failed check (the scored agent broke the contract), 2 wrong use, 130 stopped by Ctrl-C or
SIGTERM.
"""

import argparse
import sys
from collections.abc import Callable, Sequence
from typing import Any, Final

from overcooked_bench.commands.common import Parser, printable_everywhere
from overcooked_bench.commands.compare import add_compare
from overcooked_bench.commands.crossplay import add_crossplay
from overcooked_bench.commands.explain import add_explain
from overcooked_bench.commands.export import add_export
from overcooked_bench.commands.games.group import add_games
from overcooked_bench.commands.leaderboard import add_leaderboard
from overcooked_bench.commands.listing import add_list
from overcooked_bench.commands.play import add_play
from overcooked_bench.commands.pool import add_pool
from overcooked_bench.commands.replay import add_replay
from overcooked_bench.commands.report import add_report
from overcooked_bench.commands.scenarios import add_scenarios
from overcooked_bench.commands.score import add_score
from overcooked_bench.commands.submission import add_submission
from overcooked_bench.commands.train import add_train
from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.files import printable
from overcooked_bench.processes import sigterm_as_ctrl_c

COMMANDS: Final[list[Callable[[Any], None]]] = [
    *(add_score, add_report, add_compare, add_explain, add_replay, add_crossplay, add_scenarios),
    *(add_train, add_pool, add_games, add_play, add_export, add_submission, add_leaderboard, add_list),
]
"""What declares each command, in the order of `--help`."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs the given command.

    Args:
        arguments: The command line without the program's name; `sys.argv` by default.

    Returns:
        The exit code.
    """
    printable_everywhere()
    with sigterm_as_ctrl_c():
        return _run(list(sys.argv[1:] if arguments is None else arguments))


def _run(given: list[str]) -> int:
    try:
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
        print(f"overcooked-bench: {printable(error)}", file=sys.stderr)
        return getattr(error, "exit_code", OvercookedBenchError.exit_code)


def _parser() -> Parser:
    parser = Parser(
        prog="overcooked-bench",
        description="Score agents that cooperate with strangers in Overcooked kitchens.",
        epilog="example:\n  overcooked-bench score greedy\n\nEach command has its own --help with an example.",
    )
    parser.add_argument("--version", action=_Version, help="show the version and exit")
    commands = parser.add_subparsers(metavar="COMMAND", required=True)
    for add in COMMANDS:
        add(commands)
    return parser


class _Version(argparse.Action):
    """Looks the version up only when it is asked for."""

    def __init__(self, option_strings: Sequence[str], dest: str, help: str) -> None:
        super().__init__(option_strings, dest, nargs=0, help=help)

    def __call__(self, parser: argparse.ArgumentParser, *_: Any) -> None:
        from importlib.metadata import version

        print(f"overcooked-bench {version('overcooked-bench')}")
        parser.exit()
