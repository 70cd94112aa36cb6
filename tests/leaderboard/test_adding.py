"""An audited result becomes an entry: its worst games are kept, and played from there."""

import json
import shutil

import pytest

from overcooked_bench.cli import main
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.evaluation.scores import read_scores
from overcooked_bench.leaderboard.audit.audit import audit, withdraw
from overcooked_bench.leaderboard.audit.records import read_audit
from overcooked_bench.leaderboard.site.adding import add
from overcooked_bench.leaderboard.site.build import build
from overcooked_bench.leaderboard.site.entries import EntryError
from overcooked_bench.leaderboard.site.worst import worst_games
from tests.evaluation.made import protocol_text, reporting, score
from tests.leaderboard.made import edit, write_submission


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """A folder with an audited result and the submission that it is said to be of."""
    home = tmp_path_factory.mktemp("adding")
    rules = read_protocol(protocol_text(episodes=2, layouts=["cramped_room"], horizon=60), "tiny.yaml")
    mine = str(write_submission(home / "mine"))
    score(mine, reporting(rules, headlines=("mean",), metrics=("mean", "curve")), output=home / "result")
    audit(home / "result", mine, everything=True)
    assert main(["leaderboard", "add", str(home / "result"), str(home / "mine"), str(home / "results")]) == 0
    return home


@pytest.fixture
def entry(made, tmp_path):
    name = f"mine-{read_scores(made / 'result').protocol.name}"
    shutil.copytree(made / "results" / name, tmp_path / "results" / name)
    return tmp_path / "results" / name


def test_an_entry_has_its_worst_games_and_no_other_episode(made, entry, tmp_path):
    assert sorted(file.name for file in entry.iterdir()) == [
        "audit.json",
        "score.json",
        "submission.yaml",
        "worst.json",
    ]
    scores = read_scores(entry)
    kept = worst_games(scores, entry)
    assert [one.episode for one in kept] == [one.episode for one in worst_games(scores, made / "result")]
    assert all(len(list(one.frames())) == 61 for one in kept)
    built = build(tmp_path / "results", tmp_path / "site")
    assert built.refused == ()
    page = (tmp_path / "site" / "entries" / f"{entry.name}.html").read_text()
    assert page.count("<div data-kitchen><script") == len(kept)
    assert "overcooked-bench leaderboard audit" in page


@pytest.mark.parametrize(
    ("file", "old", "new", "said"),
    [
        ("worst.json", '"cramped_room"', '"/etc/passwd"', "no shipped layout"),
        ("worst.json", '"sha256": "', '"sha256": "0', "of another schema, agent or protocol"),
        ("worst.json", '"schema": 1', '"schema": "1"', "not a worst.json"),
        ("submission.yaml", "name: mine", "name: another", "name the folder another"),
    ],
)
def test_what_does_not_fit_together_is_refused_with_the_reason(file, old, new, said, entry, tmp_path):
    edit(entry / file, {old: new})
    (refused,) = build(tmp_path / "results", tmp_path / "site").refused
    assert said in refused.reason


def test_games_that_do_not_bring_their_points_are_refused(entry, tmp_path):
    content = json.loads((entry / "worst.json").read_text())
    content["games"][0][8] += 20.0
    (entry / "worst.json").write_text(json.dumps(content))
    (refused,) = build(tmp_path / "results", tmp_path / "site").refused
    assert "the joint actions bring" in refused.reason


def test_an_entry_is_written_again_but_never_replaced_by_another_agent(made, entry, tmp_path):
    before = (entry / "score.json").read_bytes()
    assert add(made / "result", made / "mine", tmp_path / "results") == entry
    shutil.copytree(made / "result", tmp_path / "other")
    edit(tmp_path / "other" / "score.json", {read_scores(entry).agent.sha256: "0" * 64})
    with pytest.raises(EntryError, match="another agent has this name"):
        add(tmp_path / "other", made / "mine", tmp_path / "results")
    assert (entry / "score.json").read_bytes() == before


def test_a_submission_that_was_changed_after_its_score_is_not_added(made, tmp_path):
    shutil.copytree(made / "mine", tmp_path / "mine")
    edit(tmp_path / "mine" / "submission.yaml", {"human_data: false": "human_data: true"})
    with pytest.raises(EntryError, match="not the files that were scored"):
        add(made / "result", tmp_path / "mine", tmp_path / "results")


def test_an_entry_that_was_withdrawn_is_never_restored_by_adding_it_again(made, entry, tmp_path):
    withdraw(entry, "trained on its partners")
    with pytest.raises(EntryError, match="was withdrawn, and stays so"):
        add(made / "result", made / "mine", tmp_path / "results")
    shutil.copytree(made / "result", tmp_path / "again")
    withdraw(tmp_path / "again", "trained on its partners, too")
    add(tmp_path / "again", made / "mine", tmp_path / "results")
    assert read_audit(entry).withdrawn.reason == "trained on its partners, too"


def test_no_audit_of_before_stays_with_a_result_that_nobody_audited(made, entry, tmp_path):
    shutil.copytree(made / "result", tmp_path / "again", ignore=shutil.ignore_patterns("audit.json"))
    add(tmp_path / "again", made / "mine", tmp_path / "results")
    assert not (entry / "audit.json").exists()
