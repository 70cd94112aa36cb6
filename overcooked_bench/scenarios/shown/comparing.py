"""Reads reports of the suite, lists what changed between two, and tabulates categories."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

from overcooked_bench.documents import read_json
from overcooked_bench.rendering.table import Table
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.results import SCHEMA, Tally, tallies, tally

_ALL: Final = "all"


MOST_BYTES: Final = 64 << 20
"""Of a report."""


class Changes(NamedTuple):
    """The differences between two reports, by item ids.

    Attributes:
        failing: Failed now and passed before.
        passing: Passed now and failed before.
        added: Not in the older one.
    """

    failing: tuple[str, ...]
    passing: tuple[str, ...]
    added: tuple[str, ...]


def read_report(path: str | Path) -> dict[str, Any]:
    """Reads a report that `--scenario-report` or `scenarios run --output` wrote.

    Raises:
        ScenarioError: It cannot be read, or is not a report of this version.
    """
    report = read_json(path, MOST_BYTES, Any, ScenarioError)
    if not isinstance(report, dict) or report.get("schema") != SCHEMA:
        schema = report.get("schema") if isinstance(report, dict) else None
        raise ScenarioError(
            f"{path}: its schema is {schema!r}, and this version reads {SCHEMA}; give a report that --scenario-report "
            "wrote"
        )
    items = report.get("items")
    if not isinstance(items, list) or not all(
        isinstance(item, dict) and isinstance(item.get("id"), str) and isinstance(item.get("status"), str)
        for item in items
    ):
        raise ScenarioError(f"{path}: its items have no id and status; give a report that --scenario-report wrote")
    return report


def changes(before: Sequence[Mapping[str, Any]], now: Sequence[Mapping[str, Any]]) -> Changes:
    """Compares the items of two reports; items that only the older one has were not played now, and are left out."""
    passed = {item["id"]: item["status"] == "passed" for item in before}
    ids = [(item["id"], item["status"] == "passed") for item in now]
    return Changes(
        failing=tuple(sorted(name for name, passes in ids if not passes and passed.get(name) is True)),
        passing=tuple(sorted(name for name, passes in ids if passes and passed.get(name) is False)),
        added=tuple(sorted(name for name, _ in ids if name not in passed)),
    )


def category_table(records: Sequence[Mapping[str, Any]]) -> Table:
    """Tabulates categories: items passed, the mean over families with its interval, and so on.

    Args:
        records: The items' records, as reports contain them.
    """
    found = tallies("category", records)
    columns = "category", "passed", "of", "mean of families [95 %]", "rate", "families", "not attempted"
    total = [_row("total", tally(records))] if len(found) > 1 else []
    return Table(columns, [_row(name, counted) for name, counted in found.items()], total)


def agents_table(played: Mapping[str, Sequence[Mapping[str, Any]]]) -> Table:
    """Tabulates agents: how many items of each category they pass, and how many discriminate.

    An item discriminates if one agent passes it and another fails it; a scenario, if one of its items does.

    Args:
        played: Records of the same items for each agent.
    """
    first = next(iter(played.values()))
    found = list(tallies("category", first))
    ids = {name: {r["id"] for r in first if name in (r["category"], _ALL)} for name in (*found, _ALL)}
    scenarios = {r["id"]: r["scenarios"] for r in first}
    passed = {agent: {r["id"] for r in records if r["status"] == "passed"} for agent, records in played.items()}
    apart = {item for item in scenarios if len({item in own for own in passed.values()}) > 1}
    rows = [[agent, *(str(len(own & some)) for some in ids.values())] for agent, own in passed.items()]
    separating = [len({scenario for item in apart & some for scenario in scenarios[item]}) for some in ids.values()]
    foot = [
        ["items", *(str(len(some)) for some in ids.values())],
        ["items that discriminate", *(str(len(apart & some)) for some in ids.values())],
        ["scenarios that discriminate", *map(str, separating)],
    ]
    return Table(["", *ids], rows, foot)


def _row(name: str, counted: Tally) -> tuple[str, ...]:
    share = f"{counted.mean_rate:.2f}"
    missing = str(counted.not_attempted) if counted.not_attempted else "-"
    return name, str(counted.passed), str(counted.n), str(counted.score), share, str(counted.families), missing
