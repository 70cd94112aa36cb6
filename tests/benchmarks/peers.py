"""Measures other implementations of the kitchen beside ours, in turns, and puts the table into RESULTS.md.

uv venv peers/ai && uv pip install -p peers/ai overcooked-ai==1.1.0 scipy
uv venv peers/marl && uv pip install -p peers/marl jaxmarl==0.2.0
python -m tests.benchmarks.peers --overcooked-ai-python peers/ai/bin/python --jaxmarl-python peers/marl/bin/python
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path
from typing import Final

from pytest_benchmark.plugin import pytest_benchmark_generate_machine_info
from pytest_benchmark.utils import get_commit_info

from tests.benchmarks.results import RESULTS, circumstances, libraries, millions, table, write_section

PROGRAMS: Final = Path(__file__).with_name("programs")
OURS: Final = "overcooked_bench"
KITCHENS: Final = (1, 30, 256)


@dataclass
class Peer:
    """One implementation.

    Attributes:
        name: As in the table.
        program: The file in `programs/` that measures it.
        python: The interpreter that has it, or None where it is not to be measured.
        kitchens: Numbers of kitchens that it can play at once.
        version: What it said of itself.
        rates: Joint steps per second of all blocks of steps, by number of kitchens.
    """

    name: str
    program: str
    python: str | None
    kitchens: tuple[int, ...] = KITCHENS
    version: str = ""
    rates: dict[int, list[float]] = field(default_factory=dict)

    def measure(self, seconds: float) -> None:
        """Runs the program once more.

        Raises:
            RuntimeError: It failed; holds the end of what it said.
        """
        if self.python is None:
            return
        numbers = ",".join(map(str, self.kitchens))
        command = [self.python, str(PROGRAMS / self.program), numbers, str(seconds)]
        done = subprocess.run(command, capture_output=True, text=True)
        if done.returncode:
            raise RuntimeError(f"measuring {self.name} failed:\n{done.stderr[-2000:]}")
        told = json.loads(done.stdout.splitlines()[-1])  # the packages greet before
        self.version = told["version"]
        for kitchens, rates in told["rates"].items():
            self.rates.setdefault(int(kitchens), []).extend(rates)

    def rate(self, kitchens: int) -> float | None:
        """Returns the median rate, or None where it was not measured."""
        return statistics.median(self.rates[kitchens]) if kitchens in self.rates else None


def cell(peer: Peer, ours: Peer, kitchens: int) -> str:
    """Writes median, best, and how many times as fast we are."""
    rate, our_rate = peer.rate(kitchens), ours.rate(kitchens)
    if rate is None:
        return "not measured" if peer.python is None else "-"
    told = f"{millions(rate)} ({millions(max(peer.rates[kitchens]))})"
    return told if peer is ours or our_rate is None else f"{told}; we are {our_rate / rate:.3g} times as fast"


def section(peers: list[Peer], pinned: bool) -> str:
    """Writes the section; the first peer is ourselves."""
    info = pytest_benchmark_generate_machine_info() | {"libraries": libraries()}
    rows = [
        [f"{peer.name} {peer.version}".rstrip(), *(cell(peer, peers[0], kitchens) for kitchens in KITCHENS)]
        for peer in peers
    ]
    absent = [peer.name for peer in peers if peer.python is None]
    return f"""\
## Beside other implementations

{circumstances(info, get_commit_info(), datetime.now(UTC).isoformat())}

Joint steps per second on cramped_room with both chefs' 26-channel observations of every step, 400 steps per episode,
random actions drawn within the measured time. All in one run, in turns{pinned * ", on one core"}: medians of blocks of
400 steps, the best block in brackets.

{table(["kitchens at once", *map(str, KITCHENS)], rows)}
overcooked-ai is the reference, plain Python, one kitchen at a time: N of them take N times as long. JaxMARL runs a
compiled scan on the processor, without the time to compile it (seconds for each number of kitchens); its kitchen has
one recipe, starts in other cells and looks a random way, and it returns no events. Ours is called from Python for every
step.{f" Not measured, since no interpreter was given: {', '.join(absent)}." if absent else ""}
"""


def on_one_core() -> bool:
    """Keeps this process, and the programs that it starts, on one core; tells whether the system can."""
    if not hasattr(os, "sched_setaffinity"):
        return False
    os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    return True


def main() -> None:
    """Measures what the command line names."""
    parser = argparse.ArgumentParser(description="Measures other implementations of the kitchen beside ours.")
    parser.add_argument("--overcooked-ai-python", help="an interpreter that has overcooked-ai 1.1.0 and scipy")
    parser.add_argument("--jaxmarl-python", help="an interpreter that has jaxmarl 0.2.0")
    parser.add_argument("--seconds", type=float, default=2.0, help="for each number of kitchens and turn")
    parser.add_argument("--turns", type=int, default=3, help="how often each is measured")
    parser.add_argument("--into", type=Path, default=RESULTS, help="the Markdown file, RESULTS.md by default")
    arguments = parser.parse_args()
    peers = [
        Peer(OURS, "with_overcooked_bench.py", sys.executable),
        Peer("overcooked-ai", "with_overcooked_ai.py", arguments.overcooked_ai_python, kitchens=(1,)),
        Peer("JaxMARL", "with_jaxmarl.py", arguments.jaxmarl_python),
    ]
    pinned = on_one_core()
    for turn in range(arguments.turns):
        for peer in peers:
            print(f"turn {turn + 1} of {arguments.turns}: {peer.name}", file=sys.stderr, flush=True)
            peer.measure(arguments.seconds)
    text = section(peers, pinned)
    write_section("peers", text, arguments.into)
    print(text)


if __name__ == "__main__":
    main()
