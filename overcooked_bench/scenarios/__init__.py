"""Cooperation unit tests: short edge cases, each with a verdict that a film of a few steps explains."""

from typing import Final

CATEGORIES: Final = ("state", "partner", "memory", "convention", "horizon")
"""What a scenario is a test of, in the order of tables."""
