"""The workflows of the leaderboard: what they may do, and that untrusted text reaches no command line."""

import re
import shlex
from pathlib import Path

import pytest
import yaml

from overcooked_bench.cli import _parser

FOLDER = Path(__file__).parents[2] / ".github" / "workflows"
NAMES = sorted(file.name for file in FOLDER.glob("*.yml"))


def workflow(name):
    return yaml.safe_load((FOLDER / name).read_text())


def steps(name):
    return [step for job in workflow(name)["jobs"].values() for step in job["steps"]]


def lines(name):
    return [line.strip() for step in steps(name) for line in step.get("run", "").splitlines()]


def rights(name):
    """What each job may write."""
    whole = workflow(name)
    given = {job: {**whole["permissions"], **(each.get("permissions") or {})} for job, each in whole["jobs"].items()}
    return {job: {right for right, level in all_of.items() if level == "write"} for job, all_of in given.items()}


def test_a_pull_request_is_reviewed_with_read_rights_and_without_secrets():
    whole = workflow("submission.yml")
    assert list(whole[True]) == ["pull_request"]  # YAML takes `on` for true
    assert whole["permissions"] == {"contents": "read"}
    assert rights("submission.yml") == {"review": set()}
    text = (FOLDER / "submission.yml").read_text()
    assert "secrets" not in text.partition("name:")[2]
    assert "token" not in text


def test_only_the_second_workflow_may_comment_and_only_the_third_may_publish():
    assert rights("submission-table.yml") == {"post": {"pull-requests"}}
    assert list(workflow("submission-table.yml")[True]) == ["workflow_run"]
    assert workflow("submission-table.yml")[True]["workflow_run"]["workflows"] == [workflow("submission.yml")["name"]]
    assert rights("leaderboard.yml") == {"build": set(), "publish": {"pages", "id-token"}}
    assert workflow("leaderboard.yml")[True]["push"]["branches"] == ["main"]


def test_the_job_that_may_comment_runs_the_default_branch_alone():
    (checkout,) = (step["with"] for step in steps("submission-table.yml") if "checkout" in step.get("uses", ""))
    assert checkout["ref"] == "${{ github.event.repository.default_branch }}"
    (download,) = (step["with"] for step in steps("submission-table.yml") if "download" in step.get("uses", ""))
    assert download["path"] == "untrusted"
    assert [line for line in lines("submission-table.yml") if "untrusted" in line] == [
        "overcooked-bench leaderboard comment untrusted/review.json --changes changes.txt > comment.md"
    ]


@pytest.mark.parametrize("name", NAMES)
def test_no_expression_reaches_a_command_line(name):
    assert not [line for line in lines(name) if "${{" in line]
    assert "pull_request_target" not in workflow(name)[True]


@pytest.mark.parametrize("name", NAMES)
def test_actions_are_pinned_and_leave_no_token(name):
    used = [step for step in steps(name) if "uses" in step]
    assert all(re.fullmatch(r"actions/[\w-]+@[0-9a-f]{40}", step["uses"]) for step in used)
    assert all(step["with"]["persist-credentials"] is False for step in used if "/checkout@" in step["uses"])


@pytest.mark.parametrize("name", NAMES)
def test_jobs_end_and_their_commands_exist(name):
    assert all(job["timeout-minutes"] <= 180 for job in workflow(name)["jobs"].values())
    ours = [line.partition(" > ")[0] for line in lines(name) if line.startswith("overcooked-bench ")]
    assert ours
    for line in ours:
        _parser().parse_args(shlex.split(line)[1:])
