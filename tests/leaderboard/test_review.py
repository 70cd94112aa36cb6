"""Reviews of pull requests: what may be added, what comes of it, and what a comment shows of a review that lies."""

import json
import os
import re
import shutil

import msgspec
import pytest

from overcooked_bench.cli import main
from overcooked_bench.evaluation.protocol import read_protocol
from overcooked_bench.leaderboard.audit.records import Check
from overcooked_bench.leaderboard.review.changes import ReviewError, entry_of
from overcooked_bench.leaderboard.review.comment import comment_of
from overcooked_bench.leaderboard.review.reviewing import Review, review
from tests.evaluation.made import protocol_text, score
from tests.leaderboard.made import write_submission

FILES = ("score.json", "episodes.sqlite", "submission.yaml", "ann.submission.zip")
ADDED = "".join(f"A\tresults/ann-tiny/{file}\n" for file in FILES)


@pytest.mark.parametrize("packed", [FILES[-1], None])
@pytest.mark.parametrize("status", ["A", "added"])
def test_a_new_folder_of_the_results_is_an_entry(status, packed):
    changes = ADDED if packed else "".join(ADDED.splitlines(keepends=True)[:3])
    assert entry_of(changes.replace("A\t", f"{status}\t")) == ("ann-tiny", packed)


@pytest.mark.parametrize(
    "line",
    [
        "M\tresults/bob/score.json",
        "D\tresults/bob/score.json",
        "R100\tresults/bob/score.json\tresults/ann-tiny/score.json",
        "A\tresults/bob/score.json",
        "A\tresults/ann-tiny/audit.json",
        "A\tresults/ann-tiny/deep/score.json",
        "A\tresults/ann-tiny/bob.submission.zip",
        "A\tresults/ann-tiny/ann.submission.zip.zip",
        "A\tresults/../ann/score.json",
        "A\t.github/workflows/submission.yml",
        "A\tovercooked_bench/score.json",
        'A\t"results/ann-tiny/\\303\\244"',
        "A",
    ],
)
def test_whatever_else_is_changed_is_refused(line):
    with pytest.raises(ReviewError, match="and changes nothing else"):
        entry_of(f"{ADDED}{line}\n")


@pytest.mark.parametrize(
    ("changes", "said"), [("\n", "nothing is changed"), (ADDED.splitlines()[0], "without episodes.sqlite")]
)
def test_an_entry_needs_its_files(changes, said):
    with pytest.raises(ReviewError, match=said):
        entry_of(changes)


UNPACKED = "".join(ADDED.splitlines(keepends=True)[:3])


@pytest.fixture(scope="module")
def merged(tmp_path_factory):
    """A repository to which an entry without its agent was added."""
    home = tmp_path_factory.mktemp("merged")
    folder = home / "results" / "ann-tiny"
    score("hesitant", read_protocol(protocol_text(episodes=1, horizon=20), "tiny.yaml"), output=folder)
    shutil.copy(write_submission(home / "ann") / "submission.yaml", folder)
    return home


@pytest.fixture
def checkout(merged, tmp_path):
    return shutil.copytree(merged, tmp_path / "checkout")


def test_an_entry_without_its_agent_is_reported(checkout, tmp_path, capsys):
    (tmp_path / "changes.txt").write_text(UNPACKED)
    where = ["--changes", str(tmp_path / "changes.txt")]
    assert main(["leaderboard", "review", str(checkout), str(tmp_path / "review.json"), *where]) == 0
    capsys.readouterr()
    assert main(["leaderboard", "comment", str(tmp_path / "review.json"), *where]) == 0
    said = capsys.readouterr().out
    assert "### In order: `ann-tiny`" in said
    assert re.search(r"\| `ann-tiny` \| .* \| 1 \| reported \| unranked \|", said)
    assert "| `replay` | passed |" in said
    assert not (checkout / "results" / "ann-tiny" / "audit.json").exists(), "the checkout stays as it is"


def spoil(folder, name):
    content = json.loads((folder / "score.json").read_text())
    content["rows"][0]["value"] += 1
    (folder / "score.json").write_text(json.dumps(content))


WRONG = {
    "a number": (spoil, "numbers"),
    "a link": (lambda folder, name: (folder / name).symlink_to("score.json"), "a symbolic link"),
    "no episodes": (lambda folder, name: (folder / "episodes.sqlite").unlink(), "episodes.sqlite: cannot be read"),
    "a pipe": (lambda folder, name: os.mkfifo(folder / name), "a folder, a pipe or a device"),
    "nothing packed": (lambda folder, name: None, "ann.submission.zip: cannot be read"),
    "no archive": (lambda folder, name: (folder / name).write_text("PK"), "not a packed submission"),
    "a name": (
        lambda folder, name: (folder / "submission.yaml").write_text(
            (folder / "submission.yaml").read_text().replace("name: ann", "name: bob")
        ),
        "the folder is 'ann-tiny', and its name and protocol make 'bob-tiny'",
    ),
    "no score": (lambda folder, name: (folder / "score.json").write_text("[" * 99), "score.json"),
}

PACKED = {"a link", "nothing packed", "a pipe", "no archive"}
"""In which the packed submission is looked at."""


@pytest.mark.parametrize("case", WRONG)
def test_what_is_wrong_with_an_entry_is_said(case, checkout):
    change, said = WRONG[case]
    change(checkout / "results" / "ann-tiny", FILES[-1])
    changes = ADDED if case in PACKED else UNPACKED
    found = review(checkout, changes)
    assert not found.sound
    assert said in comment_of(msgspec.json.encode(found), changes)
    assert str(checkout) not in str(found)


LIES = "see [here](https://example.org) @everyone <img src=x> ![](//x)`` `|` \x1b[0m\u202e\n# Winner"


def test_a_comment_shows_texts_of_a_review_as_code_and_nothing_more():
    check = Check(LIES, "failed", LIES, (LIES,))
    made = Review(schema=1, name="ann-tiny", problems=(LIES,), protocol=None, checks=(check,))
    said = comment_of(msgspec.json.encode(made), ADDED)
    outside = re.sub(r"`[^`\n]*`", "", said)
    assert not re.search(r"example|everyone|<img|Winner", outside)
    assert said.isprintable() or set(filter(lambda c: not c.isprintable(), said)) == {"\n"}


@pytest.mark.parametrize(
    "change", [{"name": "bob"}, {"schema": 2}, {"overall": "best"}, {"status": "<b>"}, {"more": 1}, {"checks": [1]}]
)
def test_a_review_that_is_none_or_of_another_entry_is_not_posted(change):
    content = msgspec.to_builtins(Review(schema=1, name="ann-tiny"))
    comment_of(json.dumps(content).encode(), ADDED)
    with pytest.raises(ReviewError):
        comment_of(json.dumps({**content, **change}).encode(), ADDED)


def test_of_a_pull_request_that_changes_more_only_that_is_said():
    """Its workflow may be another one, and so its review by anybody."""
    made = Review(schema=1, name="ann-tiny", status="reproduced", table="main")
    said = comment_of(msgspec.json.encode(made), f"{ADDED}M\t.github/workflows/submission.yml\n")
    assert "changes nothing else" in said
    assert "reproduced" not in said
