"""Errors about layouts and states, and how messages show the given value."""

from overcooked_bench.errors import WrongUse
from overcooked_bench.files import shown


class LayoutError(WrongUse):
    """A grid or its menu breaks a rule; the message says where and what to write instead."""


class StateError(WrongUse):
    """A kitchen's state breaks a rule; the message says which entry and what to write instead."""


def said(value: object) -> str:
    """Returns any value as a text that messages can print, shortened if it is long or nested."""
    try:
        return shown(repr(value))
    except Exception:  # too deep, a number of too many digits, or a repr that fails
        return f"a value of the type {type(value).__name__}"
