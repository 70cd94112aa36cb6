"""Trains in JaxMARL's Overcooked until it earns a return; see `tests/benchmarks/programs/__init__.py`.

The wheel has the environment but not the training scripts. This is our own program for the algorithm of its
`ippo_ff_overcooked`, with the values of that script's configuration file: independent PPO, one policy for both agents,
each with its own partial rewards. What surrounds the script (Hydra, Weights & Biases, distrax) is left out, and one
update is compiled instead of all of them in a loop, both of which make it start earlier.
"""

import json
import os
import sys
import time
import warnings
from collections import deque
from importlib.metadata import version
from typing import Any, NamedTuple

os.environ["JAX_PLATFORMS"] = "cpu"
import flax.linen as nn
import jax
import jax.numpy as jnp
import jaxmarl
import numpy as np
import optax
from jaxmarl.environments.overcooked import overcooked_layouts

warnings.simplefilter("ignore", DeprecationWarning)  # it recommends its second version, another game

ASKED = json.loads(sys.argv[1])
NAMES = {
    "asymmetric_advantages": "asymm_advantages",
    "coordination_ring": "coord_ring",
    "forced_coordination": "forced_coord",
}
KITCHENS, ROLLOUT, TOTAL, EPOCHS, MINIBATCHES = 16, 128, 5_000_000, 4, 4
LEARNING_RATE, GAMMA, LAMBDA, CLIP, ENTROPY, VALUE, MAX_NORM = 2.5e-4, 0.99, 0.95, 0.2, 0.01, 0.5, 0.5
SHAPING_STEPS = 2_500_000
UPDATES = TOTAL // (KITCHENS * ROLLOUT)
AGENTS = ("agent_0", "agent_1")
ROWS = len(AGENTS) * KITCHENS

env = jaxmarl.make("overcooked", layout=overcooked_layouts[NAMES.get(ASKED["layout"], ASKED["layout"])], max_steps=400)


class Network(nn.Module):
    """Actor and critic, each of two layers of 64 with tanh."""

    @nn.compact
    def __call__(self, seen):
        def tower(width: int, scale: float):
            x = seen
            for _ in range(2):
                x = nn.tanh(nn.Dense(64, kernel_init=nn.initializers.orthogonal(2**0.5))(x))
            return nn.Dense(width, kernel_init=nn.initializers.orthogonal(scale))(x)

        return jax.nn.log_softmax(tower(6, 0.01)), tower(1, 1.0)[..., 0]


class Samples(NamedTuple):
    """One step of all rows; a rollout has them stacked."""

    seen: Any
    actions: Any
    log_probs: Any
    values: Any
    rewards: Any
    dones: Any


network = Network()
optimizer = optax.chain(
    optax.clip_by_global_norm(MAX_NORM),
    optax.adam(lambda count: LEARNING_RATE * (1 - count // (EPOCHS * MINIBATCHES) / UPDATES), eps=1e-5),
)


def rows(by_agent):
    """Stacks what both agents have of all kitchens: (2 N, ...)."""
    return jnp.concatenate([by_agent[name] for name in AGENTS]).reshape(ROWS, -1)


def of(log_probs, actions):
    return jnp.take_along_axis(log_probs, actions[:, None], 1)[:, 0]


@jax.jit
def begin(key):
    key_network, key_kitchens, key = jax.random.split(key, 3)
    shown, state = jax.vmap(env.reset)(jax.random.split(key_kitchens, KITCHENS))
    weights = network.init(key_network, rows(shown))
    return weights, optimizer.init(weights), state, rows(shown), jnp.zeros(KITCHENS), key


def advantages_of(played, last_values):
    def back(carried, samples):
        advantages, following = carried
        goes_on = 1 - samples.dones
        error = samples.rewards + GAMMA * following * goes_on - samples.values
        advantages = error + GAMMA * LAMBDA * goes_on * advantages
        return (advantages, samples.values), advantages

    start = jnp.zeros_like(last_values), last_values
    return jax.lax.scan(back, start, played, reverse=True, unroll=16)[1]


def loss(weights, samples, advantages, returns):
    logs, values = network.apply(weights, samples.seen)
    ratio = jnp.exp(of(logs, samples.actions) - samples.log_probs)
    advantages = (advantages - advantages.mean()) / (advantages.std() + 1e-8)
    gain = jnp.minimum(ratio * advantages, ratio.clip(1 - CLIP, 1 + CLIP) * advantages).mean()
    near = samples.values + (values - samples.values).clip(-CLIP, CLIP)
    errors = jnp.maximum((values - returns) ** 2, (near - returns) ** 2)
    entropy = -(jnp.exp(logs) * logs).sum(-1).mean()
    return VALUE * 0.5 * errors.mean() - gain - ENTROPY * entropy


@jax.jit
def update(weights, moments, state, seen, totals, key, number):
    """One rollout and all passes over it; also gives the returns of all steps and whether an episode ended there."""
    shaping = jnp.maximum(0.0, 1 - number * KITCHENS * ROLLOUT / SHAPING_STEPS)

    def step(carried, _):
        state, seen, totals, key = carried
        key, key_actions, key_step = jax.random.split(key, 3)
        logs, values = network.apply(weights, seen)
        actions = jax.random.categorical(key_actions, logs)
        chosen = dict(zip(AGENTS, actions.reshape(len(AGENTS), KITCHENS), strict=True))
        keys = jax.random.split(key_step, KITCHENS)
        shown, state, rewards, dones, infos = jax.vmap(env.step)(keys, state, chosen)
        partial = infos["shaped_reward"]
        paid = rows({name: rewards[name] + shaping * partial[name] for name in AGENTS})[:, 0]
        samples = Samples(seen, actions, of(logs, actions), values, paid, rows(dones)[:, 0].astype(float))
        totals = totals + rewards[AGENTS[0]]
        ended = dones["__all__"]
        return (state, rows(shown), jnp.where(ended, 0, totals), key), (samples, totals, ended)

    carried, (played, returns, ended) = jax.lax.scan(step, (state, seen, totals, key), None, ROLLOUT)
    state, seen, totals, key = carried
    advantages = advantages_of(played, network.apply(weights, seen)[1])
    batch = played, advantages, advantages + played.values
    flat = jax.tree.map(lambda x: x.reshape(ROLLOUT * ROWS, *x.shape[2:]), batch)

    def minibatch(learned, part):
        weights, moments = learned
        changes, moments = optimizer.update(jax.grad(loss)(weights, *part), moments, weights)
        return (optax.apply_updates(weights, changes), moments), None

    def epoch(carried, _):
        learned, key = carried
        key, key_order = jax.random.split(key)
        order = jax.random.permutation(key_order, ROLLOUT * ROWS).reshape(MINIBATCHES, -1)
        learned, _ = jax.lax.scan(minibatch, learned, jax.tree.map(lambda x: x[order], flat))
        return (learned, key), None

    ((weights, moments), key), _ = jax.lax.scan(epoch, ((weights, moments), key), None, EPOCHS)
    return (weights, moments, state, seen, totals, key), returns, ended


def elapsed() -> float:
    return time.time() - ASKED["started"]


carried = begin(jax.random.PRNGKey(ASKED["seed"]))
compiled = update.lower(*carried, 0).compile()
start_up = elapsed()
finished: deque[float] = deque(maxlen=ASKED["episodes"])
curve = []
for number in range(int(ASKED["share"] * UPDATES)):
    carried, returns, ended = compiled(*carried, number)
    over = np.asarray(ended)
    if not over.any():
        continue
    finished.extend(np.asarray(returns)[over].tolist())
    if len(finished) == finished.maxlen:
        curve.append((elapsed(), (number + 1) * KITCHENS * ROLLOUT, sum(finished) / len(finished)))
        if curve[-1][2] >= ASKED["goal"]:
            break
reached = bool(curve) and curve[-1][2] >= ASKED["goal"]
told = f"{version('jaxmarl')}, jax {version('jax')}"
print(json.dumps({"version": told, "start_up": start_up, "curve": curve, "reached": reached}))
