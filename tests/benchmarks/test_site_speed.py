"""How long the leaderboard's page takes with 1,000 entries: to build, and to be seen."""

import random
import time
from pathlib import Path

import pytest

from overcooked_bench.evaluation.scores import read_scores
from overcooked_bench.leaderboard.site.build import build
from tests.leaderboard.results import write_entry

pytestmark = pytest.mark.benchmark

ROW = Path(__file__).parents[2] / "baselines" / "board" / "partner-blind"


def test_a_thousand_entries_are_built_within_a_minute_and_seen_within_a_second(tmp_path, browser):
    scores, draws = read_scores(ROW), random.Random(0)
    for index in range(1000):
        seeds, shift = draws.choice([1, 3, 5, 10]), draws.gauss(0, 0.15)
        write_entry(tmp_path / "results", f"agent-{index}", shift=shift, seeds=seeds, scores=scores)
    begun = time.process_time()
    assert build(tmp_path / "results", tmp_path / "site").entries >= 1000
    assert time.process_time() - begun < 60
    file = tmp_path / "site" / "index.html"
    assert file.stat().st_size < 3_000_000
    page = browser.new_page()
    page.goto(file.as_uri())
    seen = page.evaluate("performance.getEntriesByName('first-contentful-paint')[0].startTime")
    print(f"built in {time.process_time() - begun:.0f} s, {file.stat().st_size:,} bytes, seen after {seen:.0f} ms")
    assert seen < 1000
