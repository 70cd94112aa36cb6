"""The pytest plugin: `pytest --pyargs overcooked_bench.unit_scenarios --agent my_agent.py`.

Every pytest run in an environment with this package loads this module, so it imports nothing that takes time. The
modules that do the work are imported once scenarios are collected or an agent is given.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from overcooked_bench.agents.isolation import HOWS
from overcooked_bench.scenarios import SUFFIX
from overcooked_bench.scenarios.plugin.stash import BENCH, MARKER, NO_AGENT

if TYPE_CHECKING:
    from collections.abc import Generator

    from overcooked_bench.scenarios.items import Select


class Scenarios:
    """Scenarios as tests of a module: `test_cooperation = Scenarios("my_scenarios/")`.

    Args:
        select: Which scenarios, as for `run_scenarios`; all that ship by default.
    """

    __test__ = False

    def __init__(self, select: Select = None) -> None:
        self.select = select


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declares the options."""
    group = parser.getgroup("overcooked-bench", "cooperation scenarios (overcooked-bench)")

    def option(name: str, **settings: Any) -> None:
        group.addoption(name, dest=f"ocb_{name.removeprefix('--').replace('-', '_')}", **settings)

    option("--agent", metavar="AGENT", help="the agent to test: my_agent.py[:function], a folder, or an agent's name")
    option("--repeats", metavar="N", type=int, help="runs of each scenario for agents that sample (default: 20)")
    option("--mode", choices=("sample", "greedy"), default="sample", help="how frozen policies act (default: sample)")
    option("--agent-training-seed", metavar="N", type=int, default=0, help="which training run to test (default: 0)")
    option(
        "--agent-warmup", metavar="N", type=int, default=0, help="first observations to show beforehand (default: 0)"
    )
    option(
        "--isolate",
        nargs="?",
        const="best",
        choices=HOWS,
        help="play a submission in processes of its own, in a sandbox of bubblewrap if there is one, or insist on that",
    )
    option("--category", metavar="A,B", action="append", help="only scenarios of these categories")
    option("--known-failures", metavar="FILE", help="ids of items that are expected to fail, one per line")
    option("--scenario-report", metavar="FILE", help="write the result of every item as JSON")
    option("--scenario-baseline", metavar="FILE", help="list what newly fails or passes since that report")
    option("--fuzz", metavar="N", type=int, help="also play N random kitchens of each family (needs hypothesis)")


def pytest_configure(config: pytest.Config) -> None:
    """Registers the markers, and loads the agent if there is one."""
    from overcooked_bench.scenarios import CATEGORIES

    for category in CATEGORIES:
        config.addinivalue_line("markers", f"{MARKER}{category}: a cooperation scenario of the category {category!r}")
    config.stash[BENCH] = None
    if config.option.ocb_agent is not None:
        from overcooked_bench.scenarios.plugin.bench import open_bench

        config.stash[BENCH] = open_bench(config)
    if not hasattr(config, "workerinput"):
        config.pluginmanager.register(_Late(config), "overcooked_bench_summary")


class _Late:
    """Hooks of the process that prints; xdist's workers do not have them.

    Args:
        config: The session's configuration.
    """

    def __init__(self, config: pytest.Config) -> None:
        self._records: dict[str, dict[str, Any]] = {}
        self._skipped = 0
        self._config = config

    def pytest_report_header(self) -> str | None:
        bench = self._config.stash[BENCH]
        return f"scenarios: {bench.title}" if bench else None

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        record = getattr(report, "scenario", None)
        if record is not None:
            self._records[record["id"]] = record
        elif isinstance(report.longrepr, tuple) and str(report.longrepr[2]).endswith(NO_AGENT):
            self._skipped += 1

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        bench = self._config.stash[BENCH]
        if self._skipped and not terminalreporter.hasopt("skipped"):
            terminalreporter.write_line(f"{self._skipped} scenarios skipped: {NO_AGENT}")
        if bench and self._records:
            from overcooked_bench.scenarios.plugin.summary import summarize

            terminalreporter.section(f"cooperation scenarios: {bench.title}")
            for line in summarize(bench, list(self._records.values())):
                terminalreporter.write_line(line)


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collects scenarios that users wrote."""
    if not file_path.name.endswith(SUFFIX):
        return None
    from overcooked_bench.scenarios.plugin.items import ScenarioFile

    return ScenarioFile.from_parent(parent, path=file_path)


def pytest_pycollect_makeitem(collector: pytest.Module | pytest.Class, name: str, obj: object) -> Any:
    """Collects the `Scenarios` of a test module."""
    if not isinstance(obj, Scenarios):
        return None
    from overcooked_bench.scenarios.plugin.items import make_items

    return make_items(collector, obj.select)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Selects categories, marks known failures, and groups items that are played together."""
    import sys

    if "overcooked_bench.scenarios.plugin.items" in sys.modules:  # else there is no scenario among them
        from overcooked_bench.scenarios.plugin.items import arrange

        arrange(config, items)


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(
    item: pytest.Item, call: pytest.CallInfo[None]
) -> Generator[None, pytest.TestReport, pytest.TestReport]:
    """Adds an item's result to its report, which workers send to the process that prints."""
    report = yield
    record = getattr(item, "scenario_record", None)
    if record is not None and call.when == "call":
        report.__dict__["scenario"] = record
    return report
