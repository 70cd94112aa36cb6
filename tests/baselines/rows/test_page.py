"""The page and the README's table, from the numbers alone."""

import re

import msgspec
import pytest

from overcooked_bench.baselines.by_hand import KEPT
from overcooked_bench.baselines.rows.written import readme_table, written
from overcooked_bench.baselines.v1_entries import BEGIN, END, main, read_standings
from tests.baselines.rows.made import entry, standings
from tests.test_readme import ROOT

RESULTS = ROOT / "baselines" / "results"


@pytest.fixture
def found():
    part = {"n": None, "h50": None, "strata": {}, "mean": None, "self_play": None, "scenarios": None, "thesis": None}
    return standings(
        entry("self-play", 0.4),
        entry("state-augmented", 0.6, crossed=150.0),
        entry("few", 0.3, seeds=3),
        entry("part", 0.2, by_seed=(), criterion=None, **part),
    )


def rows_of(table):
    return {cells[1].strip(" `"): [one.strip() for one in cells[2:-1]] for cells in (row.split("|") for row in table)}


def test_the_page_says_what_the_records_say(found):
    text = written(found)
    assert max(len(line) for line in text.splitlines() if not line.startswith("|")) <= 120
    rows = rows_of(line for line in text.split("Intervals are")[0].splitlines() if line.startswith("|"))
    assert rows["state-augmented"][0:3:2] == ["10", "a"]
    assert rows["self-play"][2] == "b"
    assert rows["few"][2] == rows["greedy"][2] == "-"
    assert rows["few"][-2:] == ["12.5 of 50", "25 % [20, 30]"]
    assert rows["part"][1] == "-"
    assert list(rows)[-1] == "greedy"
    assert "## Training seeds with one another" in text
    assert "The seeds of one method cooperate with one another: holds here." in text
    assert "| few" in text.partition("## What the training cost")[2]


def test_the_table_of_the_readme_has_a_row_for_each_entry(found):
    rows = rows_of(readme_table(found).markdown().splitlines())
    assert list(rows)[2:] == ["state-augmented", "self-play", "few", "part", "greedy"]
    assert rows["entry"] == ["seeds", "N [95 %]", "group", "H50", "own", "human"]
    alone = rows_of(readme_table(standings(entry("few", 0.3, seeds=3))).markdown().splitlines())
    assert "group" not in alone["entry"]


def test_the_page_is_written_again_from_its_numbers_to_the_same_bytes(found, tmp_path, capsys):
    (tmp_path / "v1-entries.json").write_bytes(msgspec.json.encode(found))
    readme = tmp_path / "README.md"
    readme.write_text(f"Before.\n{BEGIN}\nold\n{END}\nAfter.\n")
    given = ["--numbers", "--output", str(tmp_path), "--readme", str(readme)]
    assert main(given) == 0
    page = tmp_path / "v1-entries.md"
    page.write_text(page.read_text().partition(KEPT)[0] + f"{KEPT}\n\nMine.\n")
    before = page.read_bytes(), readme.read_bytes()
    assert main(given) == 0
    assert (page.read_bytes(), readme.read_bytes()) == before
    assert readme.read_text().startswith(f"Before.\n{BEGIN}\n| entry ")
    assert readme.read_text().endswith(f" |\n{END}\nAfter.\n")
    readme.write_text("No place.\n")
    assert main(given) == 2
    assert "no place for the table" in capsys.readouterr().err


def test_mistakes_end_in_one_message(tmp_path, capsys):
    assert main(["--numbers", "--output", str(tmp_path)]) == 2
    assert "v1-entries.json" in capsys.readouterr().err
    (tmp_path / "v1-entries.json").write_bytes(msgspec.json.encode(msgspec.structs.replace(standings(), schema=9)))
    assert main(["--numbers", "--output", str(tmp_path)]) == 2
    assert "its schema is 9" in capsys.readouterr().err


def test_the_shipped_page_and_the_readme_are_what_the_numbers_say():
    found = read_standings(RESULTS / "v1-entries.json")
    page = (RESULTS / "v1-entries.md").read_text("utf-8")
    assert page.partition(KEPT)[0] == f"{written(found)}\n"
    table = re.search(f"{BEGIN}\n(.*)\n{END}", (ROOT / "README.md").read_text("utf-8"), re.DOTALL)
    assert table is not None
    assert table[1] == readme_table(found).markdown()
