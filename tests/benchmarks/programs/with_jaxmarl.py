"""Joint steps per second of JaxMARL's Overcooked on the processor; see `tests/benchmarks/programs/__init__.py`."""

import json
import os
import sys
import time
import warnings
from importlib.metadata import version

os.environ["JAX_PLATFORMS"] = "cpu"
import jax
import jaxmarl

warnings.simplefilter("ignore", DeprecationWarning)  # it recommends its second version, another game

BLOCK = 400


def rates(num_kitchens: int, seconds: float) -> list[float]:
    env = jaxmarl.make("overcooked", max_steps=BLOCK)

    @jax.jit
    def block(carried):
        def step(carried, _):
            key, state, _, total = carried
            key, key_actions, key_step = jax.random.split(key, 3)
            drawn = jax.random.randint(key_actions, (2, num_kitchens), 0, 6)
            keys = jax.random.split(key_step, num_kitchens)
            actions = {"agent_0": drawn[0], "agent_1": drawn[1]}
            shown, state, rewards, _, _ = jax.vmap(env.step)(keys, state, actions)
            return (key, state, shown, total + rewards["agent_0"]), None

        return jax.lax.scan(step, carried, None, BLOCK)[0]

    key = jax.random.PRNGKey(0)
    shown, state = jax.vmap(env.reset)(jax.random.split(key, num_kitchens))
    carried = key, state, shown, jax.numpy.zeros(num_kitchens)
    for _ in range(2):
        carried = jax.block_until_ready(block(carried))
    assert carried[2]["agent_0"].shape == (num_kitchens, 4, 5, 26)
    found, end = [], time.perf_counter() + seconds
    while time.perf_counter() < end or not found:
        start = time.perf_counter()
        carried = jax.block_until_ready(block(carried))
        found.append(BLOCK * num_kitchens / (time.perf_counter() - start))
    return found


measured = {n: rates(int(n), float(sys.argv[2])) for n in sys.argv[1].split(",")}
print(json.dumps({"version": f"{version('jaxmarl')}, jax {version('jax')}", "rates": measured}))
