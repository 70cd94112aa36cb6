"""The page of the command line, from its parsers."""

import argparse
import re
from collections.abc import Iterator
from typing import Any, Final

from overcooked_bench.cli import COMMANDS
from overcooked_bench.commands.common import Parser

PAGE: Final = "reference/commands.md"

_HEAD: Final = """# Command line

`overcooked-bench COMMAND --help` prints the same with an example. Exit codes: 0 done, 1 a failed check (an agent broke
the contract, a file does not verify), 2 wrong use, 130 stopped by Ctrl-C or SIGTERM. Each training method has options
of its own: `overcooked-bench train METHOD --help` lists them, and [Configurations](methods.md) what they are set to.
"""


def pages() -> Iterator[tuple[str, str]]:
    """Yields the page and its text."""
    parser = Parser(prog="overcooked-bench")
    commands = parser.add_subparsers()
    for add in COMMANDS:
        add(commands)
    yield PAGE, "\n".join([_HEAD, *_below(parser, 2)])


def _below(parser: argparse.ArgumentParser, level: int) -> Iterator[str]:
    """Yields the lines of the commands below a parser."""
    for action in parser._actions:
        if isinstance(action, argparse._SubParsersAction):
            for one in dict.fromkeys(action.choices.values()):
                yield from _command(one, level)


def _command(parser: argparse.ArgumentParser, level: int) -> Iterator[str]:
    yield f"{'#' * level} {parser.prog.partition(' ')[2]}\n"
    yield f"{_plain(parser.description or '')}\n"
    _, _, example = (parser.epilog or "").partition("\n")
    yield f"```sh\n{re.sub('(?m)^ +', '', example).strip()}\n```\n"
    rows = [row for action in parser._actions for row in _row(action)]
    if rows:
        yield "\n".join(["| argument | meaning |", "|---|---|", *rows, ""])
    yield from _below(parser, level + 1)


def _row(action: argparse.Action) -> Iterator[str]:
    if isinstance(action, argparse._HelpAction | argparse._SubParsersAction) or action.help == argparse.SUPPRESS:
        return
    names = ", ".join(action.option_strings) or _value(action)
    value = f" {_value(action)}" if action.option_strings and action.nargs != 0 else ""
    shown = f"`{names}{value}`".replace("|", "\\|")
    yield f"| {shown} | {_plain((action.help or '').replace('%%', '%'))} |"


def _value(action: argparse.Action) -> str:
    """Returns how the value of an argument is written in the usage."""
    name: Any = action.metavar or ("{" + ",".join(map(str, action.choices)) + "}" if action.choices else None)
    name = " ".join(name) if isinstance(name, tuple) else name or action.dest.upper()
    many = {"?": f"[{name}]", "*": f"[{name} ...]", "+": f"{name} ...", argparse.REMAINDER: name}
    return many.get(action.nargs, name) if isinstance(action.nargs, str) else str(name)


def _plain(text: str) -> str:
    """Returns help as Markdown, in which options are code, and a bar, a star and a bracket mean themselves."""
    parts = re.split(r"(`[^`]*`|(?<!\w)--[a-z][\w=-]*)", " ".join(text.split()))
    return "".join(_part(part) for part in parts)


def _part(part: str) -> str:
    if part.startswith("--"):
        return f"`{part}`"
    return part if part.startswith("`") else re.sub(r"([|*<\[_])", r"\\\1", part)
