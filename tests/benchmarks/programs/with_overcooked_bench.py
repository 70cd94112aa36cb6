"""Joint steps per second of this package; see `tests/benchmarks/programs/__init__.py`."""

import json
import sys
import time
from importlib.metadata import version

import numpy as np

from overcooked_bench import Kitchens

BLOCK = 400


def rates(num_kitchens: int, seconds: float) -> list[float]:
    kitchens = Kitchens("cramped_room", num_kitchens)
    rng = np.random.default_rng(0)
    shown = kitchens.observe("lossless26")

    def block() -> None:
        for actions in rng.integers(0, 6, (BLOCK, num_kitchens, 2)):
            kitchens.step(actions)
            kitchens.observe("lossless26", out=shown)

    block()
    found, end = [], time.perf_counter() + seconds
    while time.perf_counter() < end or not found:
        start = time.perf_counter()
        block()
        found.append(BLOCK * num_kitchens / (time.perf_counter() - start))
    return found


print(
    json.dumps(
        {
            "version": version("overcooked-bench"),
            "rates": {n: rates(int(n), float(sys.argv[2])) for n in sys.argv[1].split(",")},
        }
    )
)
