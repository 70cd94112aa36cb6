"""Cooperation unit tests: short edge cases, each with a verdict that a few frames explain."""

from typing import Final

CATEGORIES: Final = ("state", "partner", "memory", "convention", "horizon")
"""What a scenario tests, in the order of tables."""

SUFFIX: Final = ".scenario.yaml"
"""What every scenario's file is named: its id and this; pytest collects such files from any folder."""
