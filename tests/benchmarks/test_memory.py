"""4096 kitchens of the largest classic layout stay small; part of the ordinary run, since nothing is timed."""

import json
import sys
import tracemalloc

import numpy as np
import pytest

from overcooked_bench import Kitchens
from overcooked_bench.kitchen.observations.registry import OBSERVATIONS
from tests.benchmarks.fresh import MEMORY, run

N, LAYOUT, MEGABYTES = 4096, "counter_circuit", 1e6


def play(num_kitchens: int) -> list[np.ndarray]:
    """Steps with everything that costs memory, and keeps all observations."""
    kitchens = Kitchens(LAYOUT, num_kitchens, history=3, events=True)
    kitchens.reset(seed=0)
    kitchens.step(np.full((num_kitchens, 2), 5))
    return [kitchens.observe(name) for name in OBSERVATIONS]


def test_all_arrays_together_stay_under_150_megabytes():
    play(1)  # compiles, which is not the kitchens' memory
    tracemalloc.start()
    shown = play(N)
    _, peak = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    handed_out = sum(view.nbytes for view in shown)
    assert handed_out < peak < 150 * MEGABYTES
    assert peak - handed_out < 50 * MEGABYTES


@pytest.mark.skipif(sys.platform != "linux", reason="reads /proc")
def test_kitchens_their_kernels_and_an_observation_add_less_than_150_megabytes_to_numba():
    told = json.loads(run("-c", MEMORY))
    assert 5 < told["kitchens"] < 150 * MEGABYTES / 2**20
