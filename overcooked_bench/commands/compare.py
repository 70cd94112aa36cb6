"""`overcooked-bench compare`: the differences of scores, with their intervals and tests."""

import argparse
from typing import Any

from overcooked_bench.commands.common import add_command, add_json, add_output, console, print_json


def add_compare(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "compare",
        _compare,
        "compare scores of the same games: differences with intervals and tests, and what training seeds buy",
        "overcooked-bench compare scores/mine-v1 scores/greedy-v1 --output comparison",
    )
    parser.add_argument(
        "scores",
        metavar="SCORE",
        nargs="+",
        help="two or more folders of scores, or score.json files; a difference is the first minus the second",
    )
    parser.add_argument(
        "--metric",
        metavar="NAME",
        help="name of a metric in score.json, such as n, mean or threshold (default: the protocol's headlines)",
    )
    add_output(parser, "no page is written")
    add_json(parser)


def _compare(options: argparse.Namespace) -> int:
    from pathlib import Path

    from overcooked_bench.evaluation.comparing.compare import compare
    from overcooked_bench.evaluation.shown.comparison import comparison_tables
    from overcooked_bench.evaluation.shown.comparison_page import COMPARISON_FILE, write_comparison
    from overcooked_bench.rendering.table import styled

    found = compare(*options.scores, metric=options.metric)
    file = Path(options.output) / COMPARISON_FILE if options.output else None
    if file is not None:
        file.parent.mkdir(parents=True, exist_ok=True)
        write_comparison(found, file)
    if options.json:
        print_json(found)
        return 0
    shown = console()
    shown.print(comparison_tables(found))
    if file is not None:
        shown.print(styled(f"{file}  the page", "dim"), soft_wrap=True)
    return 0
