"""What the benchmarks' JSON says about the machine: versions that matter, and no name of it."""

from typing import Any

from tests.benchmarks.results import libraries


def pytest_benchmark_update_machine_info(config: Any, machine_info: dict[str, Any]) -> None:
    machine_info.pop("node", None)
    machine_info["libraries"] = libraries()
