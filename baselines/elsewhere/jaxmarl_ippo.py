# /// script
# requires-python = ">=3.11"
# dependencies = ["jaxmarl==0.2.0", "jax[cpu]", "optax"]
# [tool.uv]
# exclude-newer = "2026-11-15T00:00:00Z"
# ///
"""Trains one agent by IPPO in JaxMARL's own kitchen; a program of its own, which needs JaxMARL and not this package.

    uv run --script jaxmarl_ippo.py SETTINGS.json FOLDER

SETTINGS.json has the fields of `Settings`. FOLDER gets `policy.npz` at the end, `policy-<share>.npz` at each share of
the steps in `snapshots`, and `result.json` with joint steps and seconds. An npz file has the actor's `kernel_<i>`
(in, out) and `bias_<i>` (out,) of each layer, float32; inputs are the flattened observation (H, W, 26), outputs
JaxMARL's actions.

Both chefs share one actor and one critic, separate fully connected networks. Inputs that are 0 in every state of the
layout are left out of the first layer while it learns: they have no effect, and no gradient.

Source: the settings and the algorithm are those of JaxMARL's `ippo_ff_overcooked` (Rutherford et al. 2024).
"""

import json
import sys
import time
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
import optax
from jaxmarl.environments.overcooked import Overcooked, overcooked_layouts

CHANNELS = 26
CHEFS, TILES, OBJECTS, URGENCY = slice(0, 10), slice(10, 16), slice(16, 25), 25


@dataclass(frozen=True)
class Settings:
    """What to train; `steps` are joint steps of all kitchens together."""

    layout: str
    seed: int
    steps: int
    num_kitchens: int
    rollout: int
    epochs: int
    minibatches: int
    learning_rate: float
    learning_rate_end: float
    gamma: float
    gae_lambda: float
    clip: float
    value_coefficient: float
    max_grad_norm: float
    entropy_start: float
    entropy_end: float
    entropy_share: float
    shaping_share: float
    hidden: list[int]
    activation: str
    random_reset: bool
    horizon: int
    snapshots: list[float]

    @property
    def updates(self) -> int:
        """Number of rollouts, each followed by an update."""
        return self.steps // (self.rollout * self.num_kitchens)


class Steps(NamedTuple):
    """One rollout: arrays of (rollout, chefs), and (rollout, chefs, inputs) for what they saw."""

    seen: jax.Array
    action: jax.Array
    log_chance: jax.Array
    value: jax.Array
    reward: jax.Array
    over: jax.Array


def live_inputs(kitchen: Overcooked) -> np.ndarray:
    """Finds the inputs that can be other than 0: their indices in the flattened observation (H, W, 26)."""
    _, state = kitchen.reset(jax.random.key(0))
    floor = ~np.asarray(state.wall_map)
    seen = np.asarray(kitchen.get_obs(state)["agent_0"])
    beside = np.zeros_like(floor)
    for axis, by in ((0, 1), (0, -1), (1, 1), (1, -1)):
        beside |= np.roll(floor, by, axis)
    live = np.zeros(seen.shape, bool)
    live[floor, CHEFS] = True
    live[..., TILES] = seen[..., TILES] > 0
    live[floor | beside, OBJECTS] = True
    live[..., [13, 17, 19, 24]] = False  # tomatoes
    live[..., URGENCY] = True
    return np.flatnonzero(live)


def dense(key: jax.Array, inputs: int, outputs: int, scale: float) -> dict[str, jax.Array]:
    """Makes a layer with orthogonal weights."""
    return {"kernel": jax.nn.initializers.orthogonal(scale)(key, (inputs, outputs)), "bias": jnp.zeros(outputs)}


def network(key: jax.Array, inputs: int, hidden: list[int], outputs: int, scale: float) -> list[dict[str, jax.Array]]:
    """Makes fully connected layers; `scale` is that of the last one."""
    widths, keys = [inputs, *hidden], jax.random.split(key, len(hidden) + 1)
    layers = [dense(keys[i], widths[i], widths[i + 1], 2**0.5) for i in range(len(hidden))]
    return [*layers, dense(keys[-1], widths[-1], outputs, scale)]


def forward(layers: list[dict[str, jax.Array]], values: jax.Array, activation: str) -> jax.Array:
    """Computes the last layer's outputs."""
    squash = {"tanh": jnp.tanh, "relu": jax.nn.relu}[activation]
    for layer in layers[:-1]:
        values = squash(values @ layer["kernel"] + layer["bias"])
    return values @ layers[-1]["kernel"] + layers[-1]["bias"]


class Training:
    """The training of one agent.

    Args:
        settings: What to train.
    """

    def __init__(self, settings: Settings) -> None:
        self.settings = settings
        self.kitchen = Overcooked(
            layout=overcooked_layouts[settings.layout], random_reset=settings.random_reset, max_steps=settings.horizon
        )
        self.live = live_inputs(self.kitchen)
        self.inputs = self.kitchen.height * self.kitchen.width * CHANNELS
        key = jax.random.key(np.uint32(settings.seed))
        self.key, actor, critic, start = jax.random.split(key, 4)
        self.weights = {
            "actor": network(actor, self.inputs, settings.hidden, self.kitchen.num_actions, 0.01),
            "critic": network(critic, self.inputs, settings.hidden, 1, 1.0),
        }
        for layers in self.weights.values():
            layers[0]["kernel"] = layers[0]["kernel"][self.live]
        updates_of = settings.epochs * settings.minibatches

        def learning_rate(count: jax.Array) -> jax.Array:
            left = 1 - (count // updates_of) / settings.updates
            return settings.learning_rate_end + (settings.learning_rate - settings.learning_rate_end) * left

        self.optimizer = optax.chain(
            optax.clip_by_global_norm(settings.max_grad_norm), optax.adam(learning_rate, eps=1e-5)
        )
        self.moments = self.optimizer.init(self.weights)
        seen, self.state = jax.vmap(self.kitchen.reset)(jax.random.split(start, settings.num_kitchens))
        self.seen = self.views(seen)

    def views(self, seen: dict[str, jax.Array]) -> jax.Array:
        """Stacks what both chefs of N kitchens see: (2 N, live inputs) float32."""
        both = jnp.concatenate([seen[agent] for agent in self.kitchen.agents])
        return both.reshape(len(both), -1)[:, self.live].astype(jnp.float32)

    def go_on(self, update: int) -> float:
        """Plays a rollout and learns from it; returns its points per step of a kitchen."""
        before = (self.weights, self.moments, self.state, self.seen, self.key)
        *after, points = self._update(before, jnp.float32(update / self.settings.updates))
        self.weights, self.moments, self.state, self.seen, self.key = after
        return float(points)

    def _restarted(self, keys: jax.Array, *over: Any) -> tuple[Any, ...]:
        """Begins new episodes: all kitchens began together and end together, which makes it cheap to do it at once."""
        return tuple(jax.vmap(self.kitchen.reset)(keys))

    @partial(jax.jit, static_argnums=0)
    def _update(self, now: tuple[Any, ...], passed: jax.Array) -> tuple[Any, ...]:
        s = self.settings
        weights, moments, state, seen, key = now
        shaping = jnp.maximum(0, 1 - passed / s.shaping_share) if s.shaping_share else jnp.float32(0)
        annealed = jnp.minimum(1, passed / s.entropy_share) if s.entropy_share else jnp.float32(1)
        entropy = s.entropy_start + (s.entropy_end - s.entropy_start) * annealed

        def play(carry: tuple[Any, ...], key: jax.Array) -> tuple[tuple[Any, ...], tuple[Steps, jax.Array]]:
            state, seen = carry
            choose, move = jax.random.split(key)
            logits = jax.nn.log_softmax(forward(weights["actor"], seen, s.activation))
            value = forward(weights["critic"], seen, s.activation)[:, 0]
            action = jax.random.categorical(choose, logits)
            log_chance = jnp.take_along_axis(logits, action[:, None], 1)[:, 0]
            joint = dict(zip(self.kitchen.agents, action.reshape(2, -1), strict=True))
            keys = jax.random.split(move, s.num_kitchens)
            views, state, points, over, info = jax.vmap(self.kitchen.step_env)(keys, state, joint)
            views, state = jax.lax.cond(over["__all__"][0], self._restarted, lambda *same: same[1:], keys, views, state)
            extra = jnp.concatenate([info["shaped_reward"][agent] for agent in self.kitchen.agents])
            soups = points[self.kitchen.agents[0]]
            reward = jnp.tile(soups, 2) + shaping * extra
            steps = Steps(seen, action, log_chance, value, reward, jnp.tile(over["__all__"], 2))
            return (state, self.views(views)), (steps, soups.mean())

        key, playing, learning = jax.random.split(key, 3)
        (state, seen), (steps, points) = jax.lax.scan(play, (state, seen), jax.random.split(playing, s.rollout))
        last = forward(weights["critic"], seen, s.activation)[:, 0]

        def backwards(carry: tuple[jax.Array, jax.Array], step: Steps) -> tuple[tuple[jax.Array, jax.Array], jax.Array]:
            advantage, after = carry
            goes_on = 1 - step.over
            advantage = (
                step.reward + s.gamma * after * goes_on - step.value + s.gamma * s.gae_lambda * goes_on * advantage
            )
            return (advantage, step.value), advantage

        _, advantages = jax.lax.scan(backwards, (jnp.zeros_like(last), last), steps, reverse=True)
        rows = (steps, advantages, advantages + steps.value)
        rows = jax.tree.map(lambda array: array.reshape(-1, *array.shape[2:]), rows)

        def loss(weights: Any, rows: tuple[Steps, jax.Array, jax.Array]) -> jax.Array:
            step, advantage, target = rows
            logits = jax.nn.log_softmax(forward(weights["actor"], step.seen, s.activation))
            value = forward(weights["critic"], step.seen, s.activation)[:, 0]
            ratio = jnp.exp(jnp.take_along_axis(logits, step.action[:, None], 1)[:, 0] - step.log_chance)
            gain = (advantage - advantage.mean()) / (advantage.std() + 1e-8)
            actor = -jnp.minimum(ratio * gain, jnp.clip(ratio, 1 - s.clip, 1 + s.clip) * gain).mean()
            near = step.value + jnp.clip(value - step.value, -s.clip, s.clip)
            critic = 0.5 * jnp.maximum((value - target) ** 2, (near - target) ** 2).mean()
            spread = -(jnp.exp(logits) * logits).sum(1).mean()
            return actor + s.value_coefficient * critic - entropy * spread

        def learn(carry: tuple[Any, Any], rows: Any) -> tuple[tuple[Any, Any], None]:
            weights, moments = carry
            changes, moments = self.optimizer.update(jax.grad(loss)(weights, rows), moments)
            return (optax.apply_updates(weights, changes), moments), None

        def epoch(carry: tuple[Any, Any], key: jax.Array) -> tuple[tuple[Any, Any], None]:
            order = jax.random.permutation(key, len(rows[1]))
            shuffled = jax.tree.map(lambda array: array[order].reshape(s.minibatches, -1, *array.shape[1:]), rows)
            return jax.lax.scan(learn, carry, shuffled)[0], None

        (weights, moments), _ = jax.lax.scan(epoch, (weights, moments), jax.random.split(learning, s.epochs))
        return weights, moments, state, seen, key, points.mean()

    def save(self, file: Path) -> None:
        """Writes the actor's weights; those of inputs that are never other than 0 are 0."""
        arrays: dict[str, np.ndarray] = {}
        for i, layer in enumerate(self.weights["actor"]):
            kernel = np.asarray(layer["kernel"])
            if i == 0:
                kernel = np.zeros((self.inputs, kernel.shape[1]), np.float32)
                kernel[self.live] = layer["kernel"]
            arrays |= {f"kernel_{i}": kernel, f"bias_{i}": np.asarray(layer["bias"])}
        np.savez(file, allow_pickle=False, **arrays)


def main(settings_file: str, folder: str) -> None:
    """Trains an agent and writes its files."""
    settings, output = Settings(**json.loads(Path(settings_file).read_text())), Path(folder)
    started = time.monotonic()
    training = Training(settings)
    per_update = settings.rollout * settings.num_kitchens
    waiting, points = sorted(settings.snapshots), []
    snapshots = {}
    for update in range(settings.updates):
        while waiting and update >= waiting[0] * settings.updates:
            snapshots[str(waiting[0])] = update * per_update
            training.save(output / f"policy-{waiting.pop(0)}.npz")
        points.append(training.go_on(update) * settings.horizon)
        if update % 100 == 99:
            print(f"{update + 1} of {settings.updates} updates: {np.mean(points[-100:]):.1f} points", flush=True)
    training.save(output / "policy.npz")
    done = {"steps": settings.updates * per_update, "seconds": time.monotonic() - started, "snapshots": snapshots}
    (output / "result.json").write_text(json.dumps(done))


if __name__ == "__main__":
    main(*sys.argv[1:])
