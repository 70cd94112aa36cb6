"""Names that the modules of the plugin share; imports nothing that takes time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import pytest

if TYPE_CHECKING:
    from overcooked_bench.scenarios.plugin.bench import Bench

NO_AGENT: Final = "no agent to test: give one with --agent my_agent.py, or the name of an agent"

MARKER: Final = "ocb_"
"""Prefix of the markers' names; a category follows."""

BENCH: Final[pytest.StashKey[Bench | None]] = pytest.StashKey()
"""The session's `Bench`."""
