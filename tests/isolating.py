"""Both levels of isolation for tests; those of the strong one are skipped where there is no bubblewrap."""

from dataclasses import replace

import pytest

from overcooked_bench.agents.isolation.bubblewrap import missing
from overcooked_bench.agents.isolation.settings import Isolation, Level, isolate

LEVELS: tuple[Level, ...] = ("strong", "weak")


def isolation_of(level: Level, act_timeout: float = 60.0) -> Isolation:
    """Returns an isolation of a level; skips the test where it cannot be had."""
    if level == "weak":
        return replace(isolate("best", act_timeout), level=level, why="a test wants it so")
    if why := missing():
        pytest.skip(f"{why}; on Debian: apt-get install bubblewrap")
    return isolate("strict", act_timeout)
