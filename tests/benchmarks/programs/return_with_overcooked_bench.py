"""Trains this package's self-play until it earns a return; see `tests/benchmarks/programs/__init__.py`."""

import json
import sys
import tempfile
import time
from collections import deque
from importlib.metadata import version
from pathlib import Path
from typing import Any

from stable_baselines3.common.callbacks import BaseCallback

from overcooked_bench.baselines.learning.algorithms import make_learner
from overcooked_bench.baselines.learning.learner import Learner
from overcooked_bench.baselines.presets import load_config
from overcooked_bench.baselines.running.place import Place
from overcooked_bench.baselines.running.run import make_env, run
from overcooked_bench.baselines.running.seeds import USER, derive_seed
from overcooked_bench.baselines.self_play import METHOD

ASKED = json.loads(sys.argv[1])


class Reached(Exception):
    """The return is earned."""


class Watch(BaseCallback):
    """Looks at each episode that ends, until the goal is reached."""

    def __init__(self) -> None:
        super().__init__()
        self.returns: deque[float] = deque(maxlen=ASKED["episodes"])
        self.curve: list[tuple[float, int, float]] = []
        self.before = self.steps = 0  # of attempts that the divergence check gave up; of all of them
        self.start_up = 0.0

    def _on_training_start(self) -> None:
        self.start_up = self.start_up or time.time() - ASKED["started"]
        self.before = self.steps
        self.returns.clear()

    def _on_step(self) -> bool:
        self.steps = self.before + self.model.num_timesteps // 2
        if not self.locals["dones"][0]:
            return True
        self.returns.extend(info["episode_soup_reward"] for info in self.locals["infos"][::2])  # both rows tell it
        if len(self.returns) == ASKED["episodes"]:
            mean = sum(self.returns) / len(self.returns)
            self.curve.append((time.time() - ASKED["started"], self.steps, mean))
            if mean >= ASKED["goal"]:
                raise Reached
        return True


settings: Any = load_config(METHOD, ASKED["configuration"], layout=ASKED["layout"], threads=1)
watch, reached = Watch(), False


def make(seed: int) -> Learner:
    return make_learner(settings, make_env(settings, self_play=True), seed)


with tempfile.TemporaryDirectory() as folder:
    try:
        seed = derive_seed(USER, ASKED["layout"], METHOD, ASKED["seed"])
        run(settings, METHOD, Place(Path(folder), seed), make, callbacks=[watch])
    except Reached:
        reached = True
print(
    json.dumps(
        {
            "version": f"{version('overcooked-bench')}, {ASKED['configuration']}",
            "start_up": watch.start_up,
            "curve": watch.curve,
            "reached": reached,
        }
    )
)
