"""Errors of what is given to a kitchen, and how messages show what was given."""

from overcooked_bench.errors import WrongUse
from overcooked_bench.files import shown


class LayoutError(WrongUse):
    """A grid or its menu breaks a rule; the message says where and what to write instead."""


class StateError(WrongUse):
    """A kitchen's state breaks a rule; the message says which entry and what to write instead."""


def said(value: object) -> str:
    """Returns a value as messages may print it, whatever it is: cut where it is long or nested."""
    try:
        return shown(repr(value))
    except Exception:  # too deep, a number of too many digits, or a repr that fails
        return f"a value of the type {type(value).__name__}"
