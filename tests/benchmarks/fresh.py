"""Python in a process of its own, as a user starts it."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

FIRST_CALL = """
import time

import overcooked_bench

start = time.perf_counter()
kitchens = overcooked_bench.Kitchens("cramped_room", 256)
kitchens.reset(seed=0)
kitchens.step([[4, 5]] * 256)
shown = kitchens.observe("lossless26")
assert shown.shape == (256, 2, 26, 4, 5)
print(time.perf_counter() - start)
"""
"""Prints the seconds from the finished import to the first observation; numba is imported on the way."""

MEMORY = """
import json
from pathlib import Path


def resident() -> float:
    fields = dict(line.split(":", 1) for line in Path("/proc/self/status").read_text().splitlines())
    return int(fields["VmRSS"].split()[0]) / 1024


before = resident()
import numba
import numpy as np

libraries = resident()
from overcooked_bench import Kitchens

kitchens = Kitchens("counter_circuit", 4096)
kitchens.reset(seed=0)
kitchens.step(np.full((4096, 2), 5))
shown = kitchens.observe("lossless26")
after = resident()
print(json.dumps({"python": before, "numba": libraries - before, "kitchens": after - libraries, "all": after}))
"""
"""Prints MiB resident: bare Python, what importing numba adds, what 4096 kitchens with their kernels and both chefs'
observations add, and all of it."""


SCORE = """
import json
import resource
import sys

import msgspec

from overcooked_bench.evaluation.protocol import load_protocol
from overcooked_bench.evaluation.score import score

rules = load_protocol("v1")
play = msgspec.structs.replace(rules.play, horizon=int(sys.argv[1]))
rules = msgspec.structs.replace(rules, play=play)
done = score("dev-v0/{layout}/sp-0", rules, output=sys.argv[2], workers=2, scenarios=False)
own, workers = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
peak = next(line.split()[1] for line in open("/proc/self/status") if line.startswith("VmHWM"))
print(json.dumps({
    "episodes": done.episodes,
    "seconds": done.scores.run["seconds"],
    "busy": own.ru_utime + own.ru_stime + workers.ru_utime + workers.ru_stime,
    "mebibytes": (int(peak) + 2 * workers.ru_maxrss) / 1024,
}))
"""
"""Scores with two workers, `sys.argv[1]` steps an episode, into the folder `sys.argv[2]`. Prints how many episodes, the
seconds on the clock and of processors, and the peak memory in MiB, as if both workers had that of the greater one."""


def run(*arguments: str, cache: Path | None = None) -> str:
    """Runs Python with these arguments, its compiled kernels kept in `cache`; gives what it printed."""
    environment = dict(os.environ) | ({"NUMBA_CACHE_DIR": str(cache)} if cache else {})
    done = subprocess.run([sys.executable, *arguments], env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def program() -> str:
    """The path of the installed `overcooked-bench`."""
    found = shutil.which("overcooked-bench", path=str(Path(sys.executable).parent))
    assert found is not None
    return found
