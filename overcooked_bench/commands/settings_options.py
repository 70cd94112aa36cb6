"""Options of the command line from the fields of a dataclass, with their types, and the texts below them as help."""

import argparse
import ast
import inspect
import textwrap
from dataclasses import fields, is_dataclass
from itertools import pairwise
from pathlib import Path
from types import UnionType
from typing import Any, Literal, get_args, get_origin, get_type_hints


def add_settings(group: Any, config: type[Any]) -> None:
    """Declares `--some-name` for each field `some_name`.

    Args:
        group: Of a parser.
        config: A dataclass whose fields are texts, numbers, paths, literals, truth values, or tuples of these.
    """
    hints, texts = get_type_hints(config), described(config)
    for field in fields(config):
        help = texts.get(field.name, "").replace("%", "%%")
        group.add_argument(f"--{field.name.replace('_', '-')}", dest=field.name, help=help, **_kind(hints[field.name]))


def show_defaults(parser: argparse.ArgumentParser, settings: Any) -> None:
    """Adds the values of settings to the help of their options."""
    for action in parser._actions:
        value = getattr(settings, action.dest, None)
        if value not in (None, ""):
            shown = " ".join(map(str, value)) if isinstance(value, tuple) else value
            action.help = f"{action.help} (default: {shown})" if shown != "" else action.help


def described(config: type[Any]) -> dict[str, str]:
    """Returns the text below each field of a dataclass and of those that it extends."""
    found = {}
    for kind in reversed(config.__mro__):
        if is_dataclass(kind):
            (tree,) = ast.parse(textwrap.dedent(inspect.getsource(kind))).body
            assert isinstance(tree, ast.ClassDef)
            for field, text in pairwise(tree.body):
                if (
                    isinstance(field, ast.AnnAssign)
                    and isinstance(field.target, ast.Name)
                    and isinstance(text, ast.Expr)
                    and isinstance(text.value, ast.Constant)
                ):
                    found[field.target.id] = " ".join(str(text.value.value).split())
    return found


def _kind(hint: Any) -> dict[str, Any]:
    """Returns what argparse is given for a type."""
    origin, inner = get_origin(hint), get_args(hint)
    if origin is UnionType:
        return _kind(next(kind for kind in inner if kind is not type(None)))
    if origin is tuple:
        return {"nargs": "*", **_kind(inner[0])}
    if origin is Literal:
        return {"choices": inner}
    if hint is bool:
        return {"action": argparse.BooleanOptionalAction}
    metavar = {int: "N", float: "X", Path: "PATH"}.get(hint, "TEXT")
    return {"type": str if hint is Path else hint, "metavar": metavar}
