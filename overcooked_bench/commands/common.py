"""What the commands share: how they are declared, and how they show what they do."""

import argparse
import sys
from collections.abc import Callable
from typing import Any


def add_command(
    commands: Any, name: str, run: Callable[[argparse.Namespace], int], summary: str, example: str
) -> argparse.ArgumentParser:
    """Declares a command.

    Args:
        commands: What `add_subparsers` gave.
        name: Of the command.
        run: Carries it out and gives the exit code.
        summary: One line, without a capital or a full stop.
        example: A command line that works.
    """
    parser: argparse.ArgumentParser = commands.add_parser(
        name,
        help=summary,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=f"example:\n  {example}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    parser.set_defaults(command=run)
    return parser


def names(text: str) -> list[str]:
    """Parses names that are separated by commas, as argparse's `type`."""
    found = [name.strip() for name in text.split(",") if name.strip()]
    if not found:
        raise argparse.ArgumentTypeError("no name given; write one or more, separated by commas")
    return found


def whole(least: int) -> Callable[[str], int]:
    """Makes a parser of whole numbers from `least`, as argparse's `type`."""

    def parse(text: str) -> int:
        try:
            number = int(text)
        except ValueError:
            number = least - 1
        if number < least:
            raise argparse.ArgumentTypeError(f"{text!r}; give a whole number from {least}")
        return number

    return parse


def console() -> Any:
    """Gives the console for tables: as wide as the terminal, else 100 columns."""
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else 100)


class ProgressBar:
    """A progress bar on standard error, where that is a terminal.

    Args:
        waiting: What it says until the first report.
    """

    def __init__(self, waiting: str) -> None:
        self._waiting = waiting

    def __enter__(self) -> Callable[[str, int, int], None]:
        """Starts it; the result reports: what has just been done, how many are done, how many there are."""
        from rich.console import Console
        from rich.progress import (
            BarColumn,
            MofNCompleteColumn,
            Progress,
            TextColumn,
            TimeElapsedColumn,
            TimeRemainingColumn,
        )

        where = Console(stderr=True)
        columns = BarColumn(), MofNCompleteColumn(), TimeElapsedColumn(), TimeRemainingColumn()
        self._bar = Progress(
            TextColumn("{task.description}"), *columns, console=where, disable=not where.is_terminal, transient=True
        )
        task = self._bar.add_task(self._waiting, total=None)
        self._bar.start()
        return lambda what, done, of: self._bar.update(task, description=what, completed=done, total=of)

    def __exit__(self, *_: object) -> None:
        """Takes it away."""
        self._bar.stop()
