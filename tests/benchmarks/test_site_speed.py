"""How long the leaderboard's page takes with 1,000 entries: to build, and to be seen."""

import time

import pytest

from overcooked_bench.leaderboard.site.build import build
from tests.leaderboard.results import write_entry

pytestmark = pytest.mark.benchmark


def test_a_thousand_entries_are_built_within_a_minute_and_seen_within_a_second(tmp_path, browser):
    for index in range(1000):
        write_entry(tmp_path / "results", f"agent-{index}", shift=-0.0003 * index, seeds=1 if index % 3 else 5)
    begun = time.process_time()
    assert build(tmp_path / "results", tmp_path / "site").entries >= 1000
    assert time.process_time() - begun < 60
    file = tmp_path / "site" / "index.html"
    assert file.stat().st_size < 3_000_000
    page = browser.new_page()
    page.goto(file.as_uri())
    seen = page.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime")
    assert seen < 1000
