"""The page that ships holds the reference rows, and is rebuilt to the same bytes."""

import json
from pathlib import Path

import pytest

from overcooked_bench.agents.entries import shipped_entries
from overcooked_bench.leaderboard.site.build import build

ROOT = Path(__file__).parents[2]
PAGE = ROOT / "docs" / "leaderboard"


@pytest.mark.slow
def test_the_shipped_page_is_rebuilt_to_the_same_bytes(tmp_path):
    built = build(ROOT / "results", tmp_path / "site")
    assert built.refused == ()
    files = {file.relative_to(PAGE): file.read_bytes() for file in PAGE.rglob("*") if file.is_file()}
    again = {file.relative_to(tmp_path / "site"): file for file in (tmp_path / "site").rglob("*") if file.is_file()}
    assert again.keys() == files.keys(), "write it again: overcooked-bench leaderboard build results docs/leaderboard"
    differ = [str(name) for name, file in again.items() if file.read_bytes() != files[name]]
    assert differ == [], "write it again: overcooked-bench leaderboard build results docs/leaderboard"


def test_every_shipped_entry_is_a_row():
    rows = {row["name"] for row in json.loads((PAGE / "table.json").read_text())["entries"]}
    assert rows >= {*shipped_entries(), "greedy"}
