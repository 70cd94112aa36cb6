"""Turns pytest-benchmark's JSON of the scores into their section of RESULTS.md.

python -m pytest tests/benchmarks/test_score_speed.py -m benchmark -n0 --benchmark-json=scores.json
python -m tests.benchmarks.score_tables scores.json
"""

import argparse
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tests.benchmarks.results import RESULTS, circumstances, millions, table, verdict, write_section

CORES = 2
SCORE_TARGETS = {"mlp": 20.0, "cnn": 90.0}  # seconds on two cores
SEEDS, SEEDS_TARGET = 5, 90.0
NETWORKS_TARGET = 4.0
CROSS_PLAY_TARGET = 60.0
MEMORY_TARGET = 2e9 / 2**20
PARTS = ("kitchens", "partners", "agent", "scripts")


def _judged(seconds: float, target: float) -> str:
    return f"{seconds / CORES:.1f} s, at most {target:g} s: {verdict(seconds / CORES <= target)}"


def cost_table(benches: Sequence[Mapping[str, Any]]) -> str:
    """Seconds of one core, and half of them: what two cores take if nothing else runs there."""
    rows = []
    for extra in (bench["extra_info"] for bench in benches):
        seconds, target = extra["seconds"], SCORE_TARGETS.get(extra.get("agent", ""), CROSS_PLAY_TARGET)
        ratio, told = extra.get("ratio_to_networks"), "-"
        if ratio:
            told = f"{ratio:.1f}"
            told += f", at most {NETWORKS_TARGET:g}: {verdict(ratio <= NETWORKS_TARGET)}" * (extra["agent"] == "mlp")
        rate = f"{millions(extra['joint_steps'] / seconds)}"
        rows.append([extra["what"], f"{seconds:.1f} s", rate, _judged(seconds, target), told])
        if extra.get("agent") == "mlp":
            every = [f"{SEEDS * seconds:.1f} s", rate, _judged(SEEDS * seconds, SEEDS_TARGET), "-"]
            rows.append([f"{SEEDS} training seeds of it", *every])
    return table(["", "one core", "joint steps/s", "two cores", "times as long as the networks"], rows)


def parts_table(benches: Sequence[Mapping[str, Any]]) -> str:
    """Where the time goes, in hundredths of all of it."""
    rows = []
    for extra in (bench["extra_info"] for bench in benches):
        shares = [extra["parts"][part] for part in PARTS]
        rows.append([extra["what"], *(f"{share:.0%}" for share in [*shares, 1 - sum(shares)])])
    return table(["", "kitchens and views", "partners' networks", "the agent", "scripted partners", "rest"], rows)


def scores_section(data: Mapping[str, Any]) -> str:
    """Writes the section from pytest-benchmark's JSON.

    Raises:
        KeyError: It holds other benchmarks.
    """
    found: dict[str, list[Mapping[str, Any]]] = {}
    for bench in data["benchmarks"]:
        found.setdefault(bench["extra_info"]["kind"], []).append(bench)
    (fresh,) = (bench["extra_info"] for bench in found["fresh score"])
    scores, memory = found["score"], fresh["mebibytes"]
    first = scores[0]["extra_info"]
    empty = [bench["extra_info"] for bench in found["overhead"]]
    overhead = ", ".join(f"{one['what']} {one['seconds'] * 1e3:.1f} ms" for one in empty)
    return f"""\
## Scores

{circumstances(data["machine_info"], data["commit_info"], data["datetime"])}

A score under the protocol v1, with every partner and floor of its pool and with itself: {first["episodes"]:,} episodes
of 400 steps. In seconds of one core, which a busy machine lengthens by less than seconds on the clock. "The networks"
are the same forward passes with nothing around them, right after each round. {SEEDS} training seeds were not measured:
they are {SEEDS} times one.

{cost_table([*scores, *found["cross-play"]])}
{parts_table(scores)}
The same score in a fresh process with two workers, from its start to its files: {fresh["seconds"]:.0f} s on the clock.
Starting takes {fresh["start_up"]:.0f} s of them, as it does with episodes of one step; in between both cores are busy
for {fresh["busy"]:.0f} s. Peak memory of all three processes, where libraries that they share count three times:
{memory * 2**20 / 1e9:.2f} GB, under 2 GB: {verdict(memory < MEMORY_TARGET)}.

A block that plays nothing and sends back as much as one of 340 episodes, by two workers of this machine:
{overhead}.
"""


def main() -> None:
    """Reads the file named on the command line."""
    parser = argparse.ArgumentParser(description="Turns pytest-benchmark's JSON into the section about scores.")
    parser.add_argument("file", type=Path, help="what --benchmark-json wrote")
    parser.add_argument("--into", type=Path, default=RESULTS, help="the Markdown file, RESULTS.md by default")
    arguments = parser.parse_args()
    write_section("scores", scores_section(json.loads(arguments.file.read_text())), arguments.into)


if __name__ == "__main__":
    main()
