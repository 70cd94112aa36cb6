"""The record of an audit: what standing follows, and what is refused when it is read."""

import json

import msgspec
import pytest

from overcooked_bench.evaluation.scores import Source
from overcooked_bench.leaderboard.audit.records import AUDIT_FILE, Audit, AuditError, Check, read_audit

PASSED, FAILED = Check("numbers", "passed", "compared"), Check("numbers", "failed", "compared", ("overall differs",))


def audit(**changes):
    facts = {
        **{"schema": 1, "date": "2026-12-01", "version": "1", "protocol": Source("v1", "a"), "pool": Source("v1", "b")},
        **{"agent": Source("ann", "c"), "score_sha256": "d", "episodes_sha256": "e", "salt": "s", "official": True},
        **{"seed": 3, "cells": 100, "played": 20, "used_pool": None, "unranked": None, "checks": (PASSED,)},
    }
    return Audit(**{**facts, **changes})


@pytest.mark.parametrize(
    ("changes", "status", "table"),
    [
        ({}, "spot-checked", "main"),
        ({"played": 100}, "reproduced", "main"),
        ({"played": 0}, "reported", "unranked"),
        ({"played": 100, "checks": (PASSED, FAILED)}, "reported", "unranked"),
        ({"used_pool": True}, "spot-checked", "open"),
        ({"unranked": "two training runs"}, "spot-checked", "unranked"),
    ],
)
def test_standing_follows_from_what_was_checked_and_is_read_back(changes, status, table, tmp_path):
    made = audit(**changes)
    made.write(tmp_path / AUDIT_FILE)
    assert read_audit(tmp_path) == made
    assert (made.status, made.table) == (status, table)


def test_a_withdrawn_result_keeps_its_record(tmp_path):
    taken = audit().withdraw("its weights were trained on v1", "2026-12-02")
    taken.write(tmp_path / AUDIT_FILE)
    assert read_audit(tmp_path).status == "withdrawn"
    assert msgspec.structs.replace(taken, withdrawn=None) == audit()


@pytest.mark.parametrize(("reason", "day"), [("", "2026-12-02"), ("two\nlines", "2026-12-02"), ("why", "2026-13-02")])
def test_a_withdrawal_needs_a_line_and_a_day(reason, day):
    with pytest.raises(AuditError):
        audit().withdraw(reason, day)


@pytest.mark.parametrize(
    "change", [{"status": "reproduced"}, {"schema": 2}, {"played": "all"}, {"extra": 1}, {"table": None}]
)
def test_a_record_that_was_edited_is_refused(change, tmp_path):
    audit().write(tmp_path / AUDIT_FILE)
    content = json.loads((tmp_path / AUDIT_FILE).read_text())
    (tmp_path / AUDIT_FILE).write_text(json.dumps({**content, **change}))
    with pytest.raises(AuditError, match=r"audit\.json"):
        read_audit(tmp_path)
