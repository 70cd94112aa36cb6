import json

import pytest

from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.shown.comparing import changes, read_report


def records(**passed):
    return [{"id": name, "status": "passed" if passes else "failed"} for name, passes in passed.items()]


def test_changes_are_between_items_that_both_have():
    told = changes(records(a=True, b=False, c=True, gone=False), records(c=False, b=True, a=True, new=False))
    assert told == (("c",), ("b",), ("new",))
    missing = [{"id": "a", "status": "not attempted"}]
    assert changes(records(a=True), missing).failing == ("a",)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "not JSON"),
        ("[1]", "its schema is None"),
        ('{"schema": 2}', "its schema is 2, and this version reads 1"),
        ('{"schema": 1}', "its items have no id and status"),
        ('{"schema": 1, "items": [{"id": "a"}]}', "its items have no id and status"),
        (b"\xff", "not JSON"),
    ],
)
def test_a_report_that_is_none_is_told(tmp_path, text, message):
    file = tmp_path / "report.json"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(ScenarioError, match=rf"report.json(:1)?: {message}"):
        read_report(file)
    with pytest.raises(ScenarioError, match="cannot be read"):
        read_report(tmp_path / "none.json")
    file.write_text(json.dumps({"schema": 1, "items": records(a=True)}))
    assert read_report(file)["items"] == records(a=True)
