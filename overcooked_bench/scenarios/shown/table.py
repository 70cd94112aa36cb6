"""Tabulates all scenarios with their figures as Markdown, and which agents each item separates.

`python -m overcooked_bench.scenarios.shown.table [AGENT ...]` prints both for the shipped scenarios;
`docs/scenarios.md` is its output. Agents are named as for `overcooked-bench scenarios run --agent`.
"""

import sys
from collections.abc import Mapping, Sequence
from itertools import groupby
from typing import Final

from overcooked_bench.agents.catalogue import find
from overcooked_bench.rendering.table import Table
from overcooked_bench.scenarios import CATEGORIES
from overcooked_bench.scenarios.items import load_items, load_scenarios
from overcooked_bench.scenarios.runner import REPEATS, run_items
from overcooked_bench.scenarios.solving.gates import MEAN_RANDOM, MOST_RANDOM, PLAYERS, GateReport, check_all

COMMAND: Final = "python -m overcooked_bench.scenarios.shown.table"

_COLUMNS: Final = f"""\
T* is the length of the shortest solution and K the number of steps that an agent has. `random` is the share of its runs
that uniformly random play passes, in the worst of the four situations (both seats, plain and mirrored): at most
{100 * MOST_RANDOM:.0f} %, and at most {100 * MEAN_RANDOM:.0f} % on average. The other columns count the situations, of
four, that are passed: by doing nothing, which must pass none; by the scripted agents and by two rigid cooks, who never
put anything down (`push` walks as if B were not there, `wait` walks around B); and by `honest`, a planner that sees
only B's past actions and has to pass all."""

_APART: Final = """\
How many items one of two agents passes and the other fails. An item is a scenario from one seat in the plain kitchen or
its mirror image, or a pair of scenarios as a whole; it is passed if at least 80 % of 20 runs pass. Agents that are
trained for one layout fail on all others."""

Verdicts = Mapping[str, Mapping[str, bool]]
"""Agent -> item -> whether it was passed."""


def gate_table(reports: Sequence[GateReport]) -> list[str]:
    """Writes the figures of scenarios as Markdown, a table for each category.

    Args:
        reports: As `check_all` gives them.
    """
    lines: list[str] = []
    for category in CATEGORIES:
        chosen = [report for report in reports if report.scenario.category == category]
        if chosen:
            columns = "", "T*", "K", "random", "stay", *PLAYERS, "honest"
            lines += [f"## {category}", "", Table(columns, [*map(figures, chosen)]).markdown(), ""]
    mean = sum(report.mean_random for report in reports) / max(1, len(reports))
    return [*lines, f"Random play passes {100 * mean:.1f} % of its runs on average."]


def apart_table(verdicts: Verdicts) -> list[str]:
    """Writes as Markdown how many items separate two agents, and which ones nobody passes."""
    rows = [
        [name, *(str(sum(one[item] != other[item] for item in one)) for other in verdicts.values())]
        for name, one in verdicts.items()
    ]
    passed = ["passed", *(str(sum(one.values())) for one in verdicts.values())]
    lines = [Table(["", *verdicts], rows, [passed]).markdown()]
    ids = list(next(iter(verdicts.values()), {}))
    nobody = [item for item in ids if not any(one[item] for one in verdicts.values())]
    everybody = [item for item in ids if all(one[item] for one in verdicts.values())]
    for told, found in (("nobody", nobody), ("everybody", everybody)):
        lines += [
            "",
            f"Of {len(ids)} items {len(found)} are passed by {told}" + (": " if found else "") + _listed(found) + ".",
        ]
    return lines


def shipped_tables(agents: Sequence[str] = ()) -> list[str]:
    """Makes both tables for the scenarios that ship.

    Args:
        agents: Names of further agents for the second one.
    """
    makers = {**PLAYERS, **{name: find(name).make for name in agents}}
    chosen = load_items()
    verdicts = {
        name: {result.item.id: result.passed for result in run_items(make, chosen, REPEATS)}
        for name, make in makers.items()
    }
    return [
        *("# Scenarios", "", f"Printed by `{' '.join([COMMAND, *agents])}`.", "", *_COLUMNS.split("\n"), ""),
        *gate_table(check_all(load_scenarios())),
        *("", "## Which agents each item separates", "", *_APART.split("\n"), ""),
        *apart_table(verdicts),
    ]


def figures(report: GateReport) -> list[str]:
    """Returns the cells of a scenario's row."""
    random = f"{100 * report.random:.1f} %"
    passed = [report.stay, *(report.players.get(name, 0) for name in PLAYERS), report.honest]
    return [report.scenario.id, str(report.steps), str(report.budget), random, *map(str, passed)]


def _listed(items: Sequence[str]) -> str:
    """Names items, the four of one scenario as one."""
    told = []
    for scenario, group in groupby(items, key=lambda item: item.partition("-seat")[0]):
        number = len(list(group))
        told.append(scenario if scenario.endswith("-pair") or number == 4 else f"{scenario} ({number} of 4)")
    return ", ".join(told)


if __name__ == "__main__":
    print("\n".join(shipped_tables(sys.argv[1:])))
