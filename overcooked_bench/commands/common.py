"""What the commands share: how they are declared, options that many have, and how they show what they do."""

import argparse
import codecs
import io
import sys
import time
from collections.abc import Callable
from typing import Any, Final, NoReturn

from overcooked_bench.agents.isolation import HOWS
from overcooked_bench.errors import WrongUse
from overcooked_bench.shelf import guess


class Parser(argparse.ArgumentParser):
    """Reports wrong arguments like all other errors: one line, exit code 2."""

    def __init__(self, *arguments: Any, **keywords: Any) -> None:
        look = {"formatter_class": argparse.RawDescriptionHelpFormatter, "allow_abbrev": False}
        super().__init__(*arguments, **{**look, **keywords})

    def parse_known_args(self, args: Any = None, namespace: Any = None) -> Any:
        """Parses, and refuses what is not known with a guess at what was meant."""
        found, unknown = super().parse_known_args(args, namespace)
        if unknown:
            known = [flag for action in self._actions for flag in action.option_strings if flag.startswith("--")]
            near = guess(unknown[0].partition("=")[0], known) if unknown[0].startswith("--") else ""
            self.error(f"unknown argument {unknown[0]!r}; {near}".rstrip("; "))
        return found, unknown

    def error(self, message: str) -> NoReturn:
        """Raises a WrongUse."""
        joined = message if message.endswith("?") else f"{message};"
        raise WrongUse(f"{joined} {self.prog} --help shows what can be written")


def add_command(
    commands: Any, name: str, run: Callable[[argparse.Namespace], int], summary: str, example: str
) -> argparse.ArgumentParser:
    """Declares a command.

    Args:
        commands: What `add_subparsers` gave.
        name: The command's name.
        run: Carries out the command and returns the exit code.
        summary: One line, without a capital or a full stop.
        example: A command line that works.
    """
    parser: argparse.ArgumentParser = commands.add_parser(
        name,
        help=summary,
        description=summary[0].upper() + summary[1:] + ".",
        epilog=f"example:\n  {example}",
    )
    parser.set_defaults(command=run)
    return parser


def add_group(commands: Any, name: str, summary: str, example: str) -> Any:
    """Declares a command that has commands of its own, as `add_command` does; returns what takes these."""
    parser = add_command(commands, name, lambda _: 0, summary, example)
    return parser.add_subparsers(metavar="COMMAND", required=True)


def add_layouts(parser: argparse.ArgumentParser, summary: str = "only these layouts") -> None:
    """Declares `--layouts`."""
    parser.add_argument("--layouts", metavar="A,B", type=names, help=summary)


def add_output(parser: argparse.ArgumentParser, default: str) -> None:
    """Declares `--output`, always a folder."""
    parser.add_argument("--output", metavar="DIR", help=f"folder to write to (default: {default})")


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Declares `--workers`; None stands for `default_workers()`."""
    parser.add_argument(
        "--workers", metavar="N", type=whole(1), help="number of worker processes (default: usable cores, at most four)"
    )


def add_engine(parser: argparse.ArgumentParser, summary: str = "where the worker processes run") -> None:
    """Declares `--engine`."""
    parser.add_argument(
        "--engine",
        default="local",
        metavar="local|dask|ray",
        help=f"{summary}; dask and ray need the extra of that name (default: local)",
    )


def add_seed(parser: argparse.ArgumentParser, summary: str) -> None:
    """Declares `--seed`, 0 by default."""
    parser.add_argument("--seed", metavar="N", type=whole(0), default=0, help=f"{summary} (default: 0)")


def add_json(parser: argparse.ArgumentParser) -> None:
    """Declares `--json`."""
    parser.add_argument("--json", action="store_true", help="print JSON instead of tables")


def add_act_timeout(parser: argparse.ArgumentParser) -> None:
    """Declares `--act-timeout`."""
    parser.add_argument(
        "--act-timeout",
        metavar="SECONDS",
        type=positive,
        default=60.0,
        help="time limit for one call of a submission's act, on a whole batch of episodes (default: 60)",
    )


def add_isolate(parser: argparse.ArgumentParser) -> None:
    """Declares `--isolate`."""
    parser.add_argument(
        "--isolate",
        nargs="?",
        const="best",
        choices=HOWS,
        help="play a submission in processes of its own that see observations and return actions, in a sandbox of "
        "bubblewrap if it is installed; --isolate=strict refuses to play without one",
    )


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


def positive(text: str) -> float:
    """Parses a number above 0, as argparse's `type`."""
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if not 0 < number < float("inf"):
        raise argparse.ArgumentTypeError(f"{text!r}; give a number above 0")
    return number


def print_json(content: Any) -> None:
    """Prints plain values and msgspec structs as JSON."""
    import msgspec

    print(msgspec.json.format(msgspec.json.encode(content), indent=2).decode())


def console() -> Any:
    """Returns the console for tables: as wide as the terminal, else 100 columns."""
    from rich.console import Console

    return Console(width=None if sys.stdout.isatty() else 100)


_PLAIN: Final = {"≥": ">=", "≤": "<=", "·": "-", "…": "...", "×": "x", "→": "->", "─": "-", "±": "+-"}
"""What is printed instead of characters that a terminal does not have."""


def printable_everywhere() -> None:
    """Makes standard output and error print any text, also where the encoding lacks a character."""

    def replaced(error: UnicodeError) -> tuple[str, int]:
        assert isinstance(error, UnicodeEncodeError)
        text = error.object[error.start : error.end]
        return "".join(_PLAIN.get(character, "?") for character in text), error.end

    codecs.register_error("overcooked_bench", replaced)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="overcooked_bench")


class ProgressBar:
    """A progress bar on standard error, where that is a terminal.

    Args:
        waiting: What it says until the first report.
    """

    def __init__(self, waiting: str) -> None:
        self._waiting = waiting

    def __enter__(self) -> Callable[..., None]:
        """Starts it; the result takes what has just been done, how many are done, how many there are.

        It takes the number of episodes played so far, too, and the bar says how many they are per second.
        """
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
        columns = BarColumn(), MofNCompleteColumn(), TextColumn("{task.fields[rate]}"), TimeElapsedColumn()
        self._bar = Progress(
            *(TextColumn("{task.description}"), *columns, TextColumn("left"), TimeRemainingColumn()),
            console=where,
            disable=not where.is_terminal,
            transient=True,
        )
        task = self._bar.add_task(self._waiting, total=None, rate="")
        first: list[tuple[float, int]] = []  # before the first report there are programs to load and to compile
        self._bar.start()

        def tell(what: str, done: int, of: int, episodes: int | None = None) -> None:
            rate, now = "", time.monotonic()
            if episodes is not None:
                first[:] = first or [(now, episodes)]
                started, before = first[0]
                rate = f"{(episodes - before) / (now - started):,.0f} episodes/s" if episodes > before else ""
            self._bar.update(task, description=what, completed=done, total=of, rate=rate)

        return tell

    def __exit__(self, *_: object) -> None:
        """Takes it away."""
        self._bar.stop()
