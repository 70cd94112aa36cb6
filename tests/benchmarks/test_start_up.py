"""How long a fresh process takes: to import, to answer `--help`, and to play its first step; and what it keeps."""

import json
import sys
from typing import Any

import pytest

from tests.benchmarks.fresh import FIRST_CALL, MEMORY, program, run

pytestmark = pytest.mark.benchmark
ROUNDS = 5


def start(benchmark: Any, what: str, call: Any, warm_up: bool = True) -> Any:
    benchmark.group = "a fresh process, from its start to its end"
    benchmark.extra_info |= {"kind": "start-up", "what": what}
    return benchmark.pedantic(call, rounds=ROUNDS, warmup_rounds=int(warm_up))


@pytest.mark.parametrize("code", ["pass", "import numpy", "import numba", "import overcooked_bench"])
def test_an_import(benchmark, code):
    assert start(benchmark, f"`{code}`", lambda: run("-c", code)) == ""


def test_help(benchmark):
    assert "score" in start(benchmark, "`overcooked-bench --help`", lambda: run(program(), "--help"))


@pytest.mark.parametrize("cache", ["warm", "cold"])
def test_the_first_call(benchmark, cache, tmp_path_factory):
    folders = [tmp_path_factory.mktemp("cache") for _ in range(ROUNDS + 1)]
    took = []

    def call() -> None:
        folder = folders[len(took)] if cache == "cold" else folders[0]
        took.append(float(run("-c", FIRST_CALL, cache=folder)))

    start(benchmark, f"import, first reset, step and observe, {cache} cache", call, warm_up=cache == "warm")
    measured = took[1:] if cache == "warm" else took
    benchmark.extra_info["first_call"] = sorted(measured)
    assert min(measured, default=1) > 0


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_memory(benchmark):
    told = start(benchmark, "4096 kitchens of counter_circuit", lambda: json.loads(run("-c", MEMORY)))
    benchmark.extra_info |= {"kind": "memory", "mebibytes": told}
    assert told["all"] > told["numba"] + told["kitchens"]
