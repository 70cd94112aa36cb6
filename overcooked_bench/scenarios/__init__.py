"""Cooperation unit tests: short edge cases that an agent passes or fails, with a few frames that show why."""

from typing import Final

CATEGORIES: Final = ("state", "partner", "memory", "convention", "horizon")
"""What a scenario tests, in the order of tables."""

SUFFIX: Final = ".scenario.yaml"
"""What every scenario's file is named: its id and this; pytest collects such files from any folder."""
