"""The rows of the leaderboard that ship: what they say of the entries, and what they leave out."""

from pathlib import Path

import msgspec
import pytest

from overcooked_bench.agents.entries import load_entry, shipped_entries
from overcooked_bench.baselines.rows.board import facts_of, write_row
from overcooked_bench.baselines.rows.playing import PlayedEntry
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.evaluation.scores import read_scores
from overcooked_bench.leaderboard.site.entries import FACTS_FILE
from overcooked_bench.leaderboard.site.worst import WORST_FILE
from overcooked_bench.leaderboard.submission.manifest import Manifest
from tests.evaluation.made import protocol_text, score

BOARD = Path(__file__).parents[3] / "baselines" / "board"


def played(name, entry, scores):
    return PlayedEntry(name, None, entry, scores, None, (), None)


@pytest.mark.parametrize("name", shipped_entries())
def test_what_ships_is_what_the_manifest_of_the_entry_says(name):
    facts = msgspec.json.decode((BOARD / name / FACTS_FILE).read_bytes(), type=Manifest)
    assert facts == facts_of(played(name, load_entry(name), read_scores(BOARD / name)))
    assert facts.used("v1") == (name == "pool-trained")


@pytest.mark.slow
def test_a_row_is_small_and_has_its_worst_games(tmp_path):
    rules = read_protocol(protocol_text(episodes=2, layouts=["cramped_room"], horizon=60), "tiny.yaml")
    scores = score("hesitant", rules, output=tmp_path / "score").scores
    write_row(played("hesitant", None, scores), tmp_path / "score", tmp_path / "row")
    kept = read_scores(tmp_path / "row")
    assert {row.metric for row in kept.rows if row.partner is not None} <= {"n", "mean"}
    assert [row for row in kept.rows if row.partner is None] == [row for row in scores.rows if row.partner is None]
    assert "started" not in kept.run
    assert (tmp_path / "row" / WORST_FILE).is_file()
