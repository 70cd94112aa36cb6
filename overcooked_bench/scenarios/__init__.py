"""Cooperation unit tests: short edge cases, each with a verdict that a few frames explain."""

from typing import Final

CATEGORIES: Final = ("state", "partner", "memory", "convention", "horizon")
"""What a scenario tests, in the order of tables."""
