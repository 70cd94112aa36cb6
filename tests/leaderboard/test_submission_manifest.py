"""`submission.yaml`: every mistake is listed with its line and what to write."""

from pathlib import Path

import pytest

from overcooked_bench.leaderboard.submission.manifest import SubmissionError, load_manifest, parse_manifest

GOLDEN = Path(__file__).parents[1] / "data" / "golden" / "submission-1.yaml"
TEXT = GOLDEN.read_text()


def test_a_manifest_of_schema_1_is_read():
    manifest = load_manifest(GOLDEN)
    assert (manifest.schema, manifest.name, manifest.joint_steps) == (1, "best-friend", 5_000_000)
    assert (manifest.commit, manifest.link) == ("0123456789abcdef" * 2 + "01234567", "https://example.org/friend")
    assert (manifest.training_pools, manifest.selection_pools) == (("train-v1",), ("dev-v1",))
    assert [manifest.used(pool) for pool in ("train-v1", "dev-v1", "v1")] == [True, True, False]


@pytest.mark.parametrize(
    ("key", "value", "words"),
    [
        ("schema", "2", "reads 1, so update it"),
        ("schema", "x", "write `schema: 1`"),
        ("name", "greedy", "that no shipped agent has"),
        ("name", "../x", "letters, digits"),
        ("name", "nul", "letters, digits"),
        ("name", "7", "`name` is 7; write a name"),
        ("contact", "nobody", "an e-mail address or a link"),
        ("contact", '"a@b\\u202ec"', "an e-mail address or a link"),
        ("licence", '"<b>"', "SPDX"),
        ("link", "javascript:alert(1)", "beginning with https://, or null"),
        ("commit", "main", "40 or 64 hexadecimal digits"),
        ("method", '""', "in one line of 3 to 200 characters"),
        ("joint_steps", "-1", "joint_steps: 5000000"),
        ("joint_steps", "many", "joint_steps: 5000000"),
        ("joint_steps", "true", "joint_steps: 5000000"),
        ("partner_runs", "1.5", "training partners; 0 if there were none"),
        ("human_data", "maybe", "true if recorded games"),
        ("training_pools", "[v11]", "did you mean 'v1'? choose from"),
        ("training_pools", "[v1, v1]", "the shipped pools"),
        ("selection_pools", "null", "[] for none"),
        ("observation", "losless", "did you mean 'lossless'? choose from"),
        ("training_seeds", "0", "from 1 to 1000"),
        ("pledge", "false", "`pledge` is false; write `pledge: true`"),
    ],
)
def test_an_impossible_value_is_named_with_its_line_and_what_to_write(key, value, words):
    lines = TEXT.splitlines()
    (number,) = [i for i, line in enumerate(lines) if line.startswith(f"{key}:")]
    lines[number] = f"{key}: {value}"
    manifest, (problem,) = parse_manifest("\n".join(lines))
    assert manifest is None
    assert problem.startswith(f"submission.yaml:{number + 1}: `{key}` is ")
    assert words in problem


def test_all_mistakes_are_listed_at_once(tmp_path):
    text = TEXT.replace("licence:", "license:").replace("contact:", "contact: [1] #").replace("joint_steps", "#")
    manifest, problems = parse_manifest(text)
    assert manifest is None
    assert len(problems) == 4
    for words in ("unknown key `license`; did you mean 'licence'?", "`contact` is [1]", "missing key `licence`"):
        assert any(words in problem for problem in problems)
    (tmp_path / "submission.yaml").write_text(text)
    with pytest.raises(SubmissionError, match="missing key `joint_steps`"):
        load_manifest(tmp_path / "submission.yaml")


@pytest.mark.parametrize(
    ("text", "words"), [("a: &a 1", "references"), ("- 1", "not a mapping"), ("", "not a mapping")]
)
def test_what_is_no_manifest_is_refused(text, words):
    manifest, problems = parse_manifest(text)
    assert manifest is None
    assert words in problems[0]
