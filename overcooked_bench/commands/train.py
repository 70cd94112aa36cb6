"""`overcooked-bench train`: train a baseline."""

import argparse
from typing import Any

from overcooked_bench.baselines.methods import METHODS, find_method
from overcooked_bench.commands.common import add_command


def add_train(commands: Any) -> None:
    """Declares the command."""
    parser = add_command(
        commands,
        "train",
        _train,
        "train a baseline; `overcooked-bench train METHOD --help` shows the method's own options",
        "overcooked-bench train self-play --layout cramped_room --seed 0 --output runs/self-play",
    )
    parser.add_argument("method", metavar="METHOD", help=", ".join(METHODS))
    parser.add_argument("options", metavar="...", nargs=argparse.REMAINDER, help="options of the method")


def _train(options: argparse.Namespace) -> int:
    code: int = find_method(options.method).main(options.options)
    return code
