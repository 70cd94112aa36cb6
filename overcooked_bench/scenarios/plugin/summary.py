"""Summarises the tested agent's results at the end of a pytest session."""

import json
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from overcooked_bench.scenarios.plugin.bench import Bench
from overcooked_bench.scenarios.results import suite_record
from overcooked_bench.scenarios.shown.comparing import category_table, changes


def summarize(bench: Bench, records: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    """Returns the lines of the summary, and writes the report if one is asked for.

    Args:
        bench: The tested agent.
        records: The items' results.
    """
    found = sorted(records, key=lambda record: str(record["id"]))
    yield from category_table(found).text()
    known = [record for record in found if bench.expected(record["id"]) is not None]
    if known:
        failing = sum(record["status"] != "passed" for record in known)
        yield f"known failures: {failing} of {len(known)} failed as expected; they are not counted as passed"
    adapted = sum(record["adapted"] for record in found)
    if adapted:
        yield f"adapted: {adapted} mirrored kitchens were shown mirrored back"
    if bench.baseline is not None:
        yield from _changes(bench.baseline, found)
    if bench.report is not None:
        report = suite_record(bench.settings, found)
        try:
            bench.report.parent.mkdir(parents=True, exist_ok=True)
            bench.report.write_text(json.dumps(report, indent=2) + "\n", "utf-8")
        except OSError as error:
            yield f"{bench.report}: the report cannot be written ({error.strerror})"
        else:
            yield f"{bench.report}  the report"


def _changes(baseline: Sequence[Mapping[str, Any]], found: Sequence[Mapping[str, Any]]) -> Iterator[str]:
    changed = changes(baseline, found)
    for what, names in (("newly failing", changed.failing), ("newly passing", changed.passing)):
        yield f"{what}: {len(names)}"
        yield from (f"  {name}" for name in names)
    if changed.added:
        yield f"not in the baseline: {len(changed.added)}"
