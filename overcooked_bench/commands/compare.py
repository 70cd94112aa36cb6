"""`overcooked-bench compare`: the difference of two scores, with its interval."""

import argparse
from typing import Any

from overcooked_bench.commands.common import add_command, add_json, console, print_json


def add_compare(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "compare",
        _compare,
        "compare two scores of the same protocol: the difference of any metric, with its interval",
        "overcooked-bench compare scores/mine-dev scores/greedy-dev --metric tail_mean",
    )
    parser.add_argument("first", metavar="SCORE", help="the folder of a score, or its score.json")
    parser.add_argument("second", metavar="SCORE", help="another score; the difference is the first minus the second")
    parser.add_argument(
        "--metric",
        metavar="NAME",
        default="mean",
        help="name of a metric in score.json, such as mean, tail_mean or threshold (default: mean)",
    )
    add_json(parser)


def _compare(options: argparse.Namespace) -> int:
    from rich.text import Text

    from overcooked_bench.evaluation.compare import compare
    from overcooked_bench.evaluation.shown.comparison import comparison_table

    found = compare(options.first, options.second, options.metric)
    if options.json:
        print_json(found)
        return 0
    shown = console()
    shown.print(comparison_table(found).terminal())
    shown.print(Text(f"\n{found.interval}", style="dim"))
    return 0
