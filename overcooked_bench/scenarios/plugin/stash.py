"""What the modules of the plugin share; it imports nothing that takes time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Final

import pytest

if TYPE_CHECKING:
    from overcooked_bench.scenarios.plugin.bench import Bench

NO_AGENT: Final = "no agent to test: give one with --agent my_agent.py, or the name of an agent"

MARKER: Final = "ocb_"
"""What the markers' names begin with; categories follow."""

BENCH: Final[pytest.StashKey[Bench | None]] = pytest.StashKey()
"""Who is tested in this session."""
