"""States of kitchens in overcooked_ai's JSON form."""

import json
from typing import Any

import numpy as np

from overcooked_bench import Kitchens, KitchenState
from overcooked_bench.kitchen.errors import StateError
from tests.fuzz.harness import TRIES, attack, mixed, seeded
from tests.fuzz.mutators import as_json, bytes_of, trees_of, written

GRID = "XPTXX\nO   P\nX   X\nXDXSX"


def states() -> list[Any]:
    """States from the middle of random play, with soups in pots, in hands and on counters."""
    kitchens = Kitchens(GRID, 12, cooking="manual", object_probability=0.9)
    kitchens.reset(seed=1)
    for joint in np.random.default_rng(0).choice(6, (40, 12, 2), p=[0.1, 0.1, 0.1, 0.1, 0.1, 0.5]):
        kitchens.step(joint)
    return [kitchens.state(i).to_dict() for i in range(12)]


@TRIES
def test_states(tries):
    kitchens = Kitchens(GRID, 1, cooking="manual")

    def read(content: bytes) -> None:
        try:
            data = json.loads(content)
        except (ValueError, RecursionError):  # of the reader, which is not ours
            raise StateError("no JSON") from None
        state = KitchenState.from_dict(data)
        assert KitchenState.from_dict(json.loads(json.dumps(state.to_dict()))).timestep == state.timestep
        kitchens.set_state(0, state)
        kitchens.step([[4, 5]])
        kitchens.reset()

    trees = states()
    seeds, rng = [written(tree).encode() for tree in trees], seeded("states")
    inputs = mixed(rng, bytes_of(seeds, rng), as_json(trees_of(trees, rng)), as_json(trees_of(trees, rng)))
    attack("KitchenState.from_dict", seeds, inputs, read, StateError, tries).check()
