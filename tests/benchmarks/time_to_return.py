"""Measures how long self-play takes to earn a return, ours and JaxMARL's, in turns on one core, for RESULTS.md.

uv venv peers/marl && uv pip install -p peers/marl jaxmarl==0.2.0
python -m tests.benchmarks.time_to_return --jaxmarl-python peers/marl/bin/python
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Any, Final

from pytest_benchmark.plugin import pytest_benchmark_generate_machine_info
from pytest_benchmark.utils import get_commit_info

from tests.benchmarks.peers import PROGRAMS, on_one_core
from tests.benchmarks.results import RESULTS, circumstances, libraries, table, verdict, write_section

LAYOUTS: Final = ("forced_coordination", "counter_circuit")
GOAL: Final = 160.0
EPISODES: Final = 64
"""Finished episodes of training that the return is a mean of, the last ones."""
TARGET: Final = 0.8
"""Of the peer's wall-clock."""
ONE_THREAD: Final = {
    "OMP_NUM_THREADS": "1",
    "MKL_NUM_THREADS": "1",
    "OPENBLAS_NUM_THREADS": "1",
    "XLA_FLAGS": "--xla_cpu_multi_thread_eigen=false intra_op_parallelism_threads=1",
}


@dataclass(frozen=True)
class Run:
    """One training until the goal; seconds from the start of the process.

    Attributes:
        start_up: Until the first step: imports, and compilation or the loading of compiled kernels.
        seconds: Until the goal, or None where the training ended before.
        steps: Joint steps until then.
    """

    start_up: float
    seconds: float | None
    steps: int

    @property
    def training(self) -> float | None:
        """Seconds without the start-up."""
        return None if self.seconds is None else self.seconds - self.start_up


@dataclass
class Trainer:
    """One program that trains.

    Attributes:
        name: As in the table.
        program: The file in `programs/`.
        python: The interpreter that has it.
        version: What it said of itself.
        runs: By layout, one for each seed.
    """

    name: str
    program: str
    python: str
    version: str = ""
    runs: dict[str, list[Run]] = field(default_factory=dict)

    def train(self, asked: dict[str, Any]) -> dict[str, Any]:
        """Runs the program once more; gives all that it said, and what it was asked.

        Raises:
            RuntimeError: It failed; holds the end of what it said.
        """
        told = json.dumps(asked | {"started": time.time()})
        command = [self.python, str(PROGRAMS / self.program), told]
        done = subprocess.run(command, capture_output=True, text=True, env=dict(os.environ) | ONE_THREAD)
        if done.returncode:
            raise RuntimeError(f"training with {self.name} failed:\n{done.stderr[-2000:]}")
        found = json.loads(done.stdout.splitlines()[-1])  # the packages talk before
        self.version = found["version"]
        seconds, steps, _ = found["curve"][-1] if found["curve"] else (None, 0, 0.0)
        run = Run(found["start_up"], seconds if found["reached"] else None, steps)
        self.runs.setdefault(asked["layout"], []).append(run)
        return {"trainer": self.name, **asked, **found}


def spread(values: Sequence[float | None], unit: str, digits: int) -> str:
    """Writes median and range; a run without a value counts as longer than all others."""
    known = [value for value in values if value is not None]
    middle, missing = median(values), len(values) - len(known)
    told = "not reached" if middle is None else f"{middle:.{digits}f} {unit}"
    within = f" ({min(known):.{digits}f} to {max(known):.{digits}f})" if known else ""
    return told + within + (f", {missing} of {len(values)} not" if missing and known else "")


def median(values: Sequence[float | None]) -> float | None:
    """Returns the median, or None where it is among the runs without a value."""
    found = statistics.median(float("inf") if value is None else value for value in values)
    return None if found == float("inf") else found


def times_table(trainers: Sequence[Trainer], goal: float) -> str:
    """Seconds and joint steps to the goal; the first trainer is judged by its time in all, over each other's."""

    rows = []
    for layout in trainers[0].runs:
        ours = median([run.seconds for run in trainers[0].runs[layout]])
        for trainer in trainers:
            runs = trainer.runs[layout]
            in_all = median([run.seconds for run in runs])
            compared = "-"
            if trainer is not trainers[0] and ours is not None and in_all is not None:
                ratio = ours / in_all
                compared = f"we take {ratio:.2f} of it, at most {TARGET}: {verdict(ratio <= TARGET)}"
            elif trainer is not trainers[0]:
                compared = f"at most {TARGET}: {verdict(ours is not None)}"
            rows.append(
                [
                    f"{layout}: {trainer.name} {trainer.version}".rstrip(),
                    spread([run.start_up for run in runs], "s", 0),
                    spread([run.training for run in runs], "s", 0),
                    spread([run.seconds for run in runs], "s", 0),
                    spread([None if run.seconds is None else run.steps / 1e6 for run in runs], "M", 2),
                    compared,
                ]
            )
    return table(["", "start-up", f"from there to {goal:g}", "in all", "joint steps", "target"], rows)


def section(trainers: Sequence[Trainer], goal: float, episodes: int, pinned: bool) -> str:
    """Writes the section; the first trainer is ourselves."""
    info = pytest_benchmark_generate_machine_info() | {"libraries": libraries()}
    seeds = len(next(iter(trainers[0].runs.values())))
    alone = "" if len(trainers) > 1 else "\nJaxMARL was not measured, since no interpreter was given."
    return f"""\
## Time to a return in self-play

{circumstances(info, get_commit_info(), datetime.now(UTC).isoformat())}

Seconds until the last {episodes} finished episodes of training earned {goal:g} points on average, partial rewards not
counted, actions sampled; {seeds} seeds in turns{pinned * ", all on one core"}, one thread. Medians, the range in
brackets. "In all" counts from the start of the process: imports, and what is compiled. Our kernels are kept on disk
from an earlier run, as they are after the first one; compiling them takes what the table of fresh processes shows.

{times_table(trainers, goal)}
Runs that the divergence check restarted count with all their time.

JaxMARL: PPO with the default values of its `ippo_ff` for Overcooked, as our own program over its environment, since its
wheel has no training scripts; without the logging of the original. Its kitchen starts in fixed cells; ours trains from
random ones.{alone}
"""


def main() -> None:
    """Measures what the command line names."""
    parser = argparse.ArgumentParser(description="Measures how long self-play takes to earn a return.")
    parser.add_argument("--jaxmarl-python", help="an interpreter that has jaxmarl 0.2.0")
    parser.add_argument("--config", default="fast", help="our configuration of self-play, fast by default")
    parser.add_argument("--layouts", nargs="+", default=list(LAYOUTS))
    parser.add_argument("--seeds", type=int, default=5, help="runs of each, 5 by default")
    parser.add_argument("--goal", type=float, default=GOAL, help="points, 160 by default")
    parser.add_argument("--episodes", type=int, default=EPISODES, help="that the return is a mean of, 64 by default")
    parser.add_argument("--share", type=float, default=1.0, help="of JaxMARL's updates after which it gives up")
    parser.add_argument("--curves", type=Path, help="a file for all runs' learning curves, a line of JSON each")
    parser.add_argument("--into", type=Path, default=RESULTS, help="the Markdown file, RESULTS.md by default")
    arguments = parser.parse_args()
    trainers = [Trainer("overcooked_bench", "return_with_overcooked_bench.py", sys.executable)]
    if arguments.jaxmarl_python:
        trainers.append(Trainer("JaxMARL", "return_with_jaxmarl.py", arguments.jaxmarl_python))
    pinned = on_one_core()
    asked = {name: getattr(arguments, name) for name in ("goal", "episodes", "share")}
    asked["configuration"] = arguments.config
    for layout in arguments.layouts:
        for seed in range(arguments.seeds):
            for trainer in trainers:
                found = trainer.train(asked | {"layout": layout, "seed": seed})
                if arguments.curves:
                    with arguments.curves.open("a") as file:
                        file.write(json.dumps(found) + "\n")
                print(f"{layout}, seed {seed}, {trainer.name}: {trainer.runs[layout][-1]}", file=sys.stderr, flush=True)
    text = section(trainers, arguments.goal, arguments.episodes, pinned)
    write_section("return", text, arguments.into)
    print(text)


if __name__ == "__main__":
    main()
