"""Learning in self-play: joint steps per second, the networks alone beside it, and where the time goes."""

import time
from collections import defaultdict
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import torch

from overcooked_bench.baselines.learning.algorithms import make_learner
from overcooked_bench.baselines.learning.learner import Learner
from overcooked_bench.baselines.learning.settings import Settings
from overcooked_bench.baselines.presets import load_config
from overcooked_bench.baselines.running.monitor import Monitor
from overcooked_bench.baselines.running.run import make_env

pytestmark = pytest.mark.benchmark

SQUARE, WIDE = "forced_coordination", "asymmetric_advantages"
GRIDS = {SQUARE: "5x5", WIDE: "9x5"}
CASES = [("fast", SQUARE, 1), ("fast", WIDE, 1), ("thesis", SQUARE, 1), ("thesis", SQUARE, 2)]
ROUNDS = {"fast": 12, "thesis": 4}


class Stopwatch:
    """Adds up the seconds that calls take.

    Attributes:
        seconds: What was read off last, by the name of the part.
    """

    def __init__(self) -> None:
        self._running: defaultdict[str, float] = defaultdict(float)
        self.seconds: dict[str, float] = {}

    def watch(self, owner: Any, method: str, name: str, when: Callable[[], bool] = lambda: True) -> None:
        """Adds a method of an object, where `when` tells at a call that it is to be counted."""
        original = getattr(owner, method)

        def timed(*arguments: Any, **keywords: Any) -> Any:
            if not when():
                return original(*arguments, **keywords)
            start = time.perf_counter()
            try:
                return original(*arguments, **keywords)
            finally:
                self._running[name] += time.perf_counter() - start

        setattr(owner, method, timed)

    def read(self) -> dict[str, float]:
        """Returns the seconds since the last time."""
        self.seconds, self._running = dict(self._running), defaultdict(float)
        return self.seconds


def networks_alone(settings: Settings) -> Callable[[], dict[str, float]]:
    """Makes the passes of the network that a rollout and an update have, on random inputs, timed apart."""
    model = make_learner(settings, make_env(settings, self_play=True), 1)
    policy, shape = model.policy, model.observation_space.shape or ()
    sizes = model.n_envs, model.batch_size
    few, many = (policy.compact(torch.randint(0, 2, (size, *shape), dtype=torch.uint8)) for size in sizes)
    updates = model.n_epochs * model.n_envs * model.n_steps // model.batch_size

    def passes() -> dict[str, float]:
        start = time.perf_counter()
        with torch.no_grad():
            for _ in range(model.n_steps + 1):
                policy.judge(few)
        between = time.perf_counter()
        for _ in range(updates):
            logs, values = policy.judge(many)
            policy.optimizer.zero_grad()
            (logs[:, 0].mean() + values.mean()).backward()
            policy.optimizer.step()
        return {"rollout": between - start, "update": time.perf_counter() - between}

    return passes


def watched_learner(settings: Settings) -> tuple[Learner, Stopwatch]:
    """Makes a learner whose parts are timed; what the network does within an update is not told apart there."""
    model = make_learner(settings, make_env(settings, self_play=True), 0)
    watch = Stopwatch()
    watch.watch(model.policy, "judge", "network", when=lambda: not torch.is_grad_enabled())
    watch.watch(model.env, "step", "kitchens")
    watch.watch(model, "collect_rollouts", "rollout")
    watch.watch(model, "train", "update")
    return model, watch


@pytest.mark.parametrize(("name", "layout", "threads"), CASES)
def test_an_update(benchmark: Any, tmp_path: Path, name: str, layout: str, threads: int) -> None:
    """Each update of the learner is timed right after the networks alone, so that both meet one load."""
    chosen = load_config("self-play", name, layout=layout, threads=threads)
    settings = replace(chosen, learning_rate_end=chosen.learning_rate)  # every call of `learn` comes to its end
    alone = networks_alone(settings)
    model, watch = watched_learner(settings)
    monitor = Monitor({}, tmp_path / "checkpoint.pt", 10**9, settings, tmp_path)
    steps = settings.num_kitchens * settings.rollout
    found: dict[str, list[float]] = defaultdict(list)

    def setup() -> None:
        for part, seconds in alone().items():
            found[f"{part}, networks alone"].append(seconds)

    def call() -> None:
        start = time.perf_counter()
        model.learn(model.n_envs * model.n_steps, monitor, reset_num_timesteps=False)
        found["all"].append(time.perf_counter() - start)
        for part, seconds in watch.read().items():
            found[part].append(seconds)

    setup()
    call()  # to load and to warm up
    found.clear()
    benchmark.group = f"learning in self-play, {name}"
    benchmark.pedantic(call, setup=setup, rounds=ROUNDS[name])
    bound = np.add(found["rollout, networks alone"], found["update, networks alone"])
    benchmark.extra_info |= {
        "kind": "training",
        "configuration": name,
        "grid": GRIDS[layout],
        "what": f"{name}, {layout} {GRIDS[layout]}, {threads} thread{'s' * (threads > 1)}",
        "threads": threads,
        "joint_steps": steps,
        "bound_median": float(np.median(bound)),
        "bound_min": float(bound.min()),
        "ratio_to_bound": float(np.median(found["all"] / bound)),
        "parts": {part: float(np.median(seconds)) for part, seconds in found.items()},
    }
    assert model.num_timesteps == 2 * steps * (1 + len(found["all"]))
    assert found["rollout"][0] + found["update"][0] <= found["all"][0]
    assert found["network"][0] + found["kitchens"][0] <= found["rollout"][0]
