"""How the benchmarks measure: rounds of a few milliseconds, many of them."""

import time
from collections.abc import Callable
from typing import Any

ROUND_SECONDS = 0.002
ROUNDS = 200


def measure(benchmark: Any, group: str, call: Callable[[], object], joint_steps: int, **facts: object) -> None:
    """Measures a call that takes microseconds, and notes the joint steps per second that it makes.

    A round is as many calls as take about two milliseconds, so that on a busy machine some rounds are undisturbed.

    Args:
        benchmark: The fixture of pytest-benchmark.
        group: Calls of one group are shown in one table, with their ratios.
        call: What is measured.
        joint_steps: Joint steps that one call plays, or writes the bytes of.
        facts: What else the JSON is to say of it.
    """
    benchmark.group = group
    for _ in range(3):
        call()
    start = time.perf_counter()
    for _ in range(5):
        call()
    iterations = max(1, round(ROUND_SECONDS * 5 / (time.perf_counter() - start)))
    benchmark.pedantic(call, rounds=ROUNDS, iterations=iterations, warmup_rounds=5)
    benchmark.extra_info |= facts | {"joint_steps": joint_steps}
    if benchmark.stats:  # absent under --benchmark-disable
        stats = benchmark.stats.stats
        benchmark.extra_info["joint_steps_per_second"] = round(joint_steps / stats.median)
        benchmark.extra_info["joint_steps_per_second_at_best"] = round(joint_steps / stats.min)
