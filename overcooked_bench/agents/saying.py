"""Puts into words what others' code raises and returns; its own words are cut and made harmless."""

from typing import Any, Final

from overcooked_bench.files import shown

MOST: Final = 500
"""Characters that are kept of an error's message or of a value."""


def say(error: BaseException) -> str:
    """Returns an error's message, one printable line, or its kind where it has none."""
    try:
        text = str(error)
    except BaseException as failed:
        _pass_on(failed)
        return "(its message cannot be shown)"
    return _line(text) if text else kind_of(error)


def describe(error: BaseException) -> str:
    """Returns an error's kind and its message, one printable line."""
    kind, text = kind_of(error), say(error)
    return kind if text == kind else f"{kind}: {text}"


def value(thing: Any) -> str:
    """Returns a value's `repr`, one printable line."""
    try:
        return _line(repr(thing))
    except BaseException as failed:
        _pass_on(failed)
        return f"an object of the type {kind_of(thing)}"


def kind_of(thing: Any) -> str:
    """Returns the name of a thing's type."""
    try:
        return _line(type(thing).__name__)
    except BaseException as failed:
        _pass_on(failed)
        return "an object"


def _line(text: object) -> str:
    return shown(shown(text, MOST), MOST)  # escaped characters are longer than they were


def _pass_on(error: BaseException) -> None:
    """Lets Ctrl-C through."""
    if isinstance(error, KeyboardInterrupt):
        raise error
