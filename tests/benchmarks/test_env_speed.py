"""Steps through Gymnasium and stable-baselines3, beside environments that do nothing: the machine's own measure."""

from itertools import cycle
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.envs.registration import EnvSpec
from gymnasium.spaces import Box, Discrete
from gymnasium.vector import AutoresetMode, SyncVectorEnv
from numpy.typing import NDArray
from stable_baselines3.common.vec_env import DummyVecEnv

from overcooked_bench.envs.sb3 import OvercookedVecEnv
from tests.benchmarks.measuring import measure

pytestmark = pytest.mark.benchmark

LAYOUT, ID, SHAPE = "cramped_room", "Overcooked/CrampedRoom-v0", (22, 4, 5)
VECTOR, SINGLE, LEARNER = "30 kitchens, one batch", "one kitchen", "64 kitchens in self-play, 128 rows"


class Nothing(gym.Env[NDArray[np.uint8], int]):
    """Shows zeros for 400 steps whatever is done."""

    def __init__(self) -> None:
        self.observation_space = Box(0, 20, SHAPE, np.uint8)
        self.action_space = Discrete(6)
        self._shown = np.zeros(SHAPE, np.uint8)
        self._clock = 0

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        self._clock = 0
        return self._shown.copy(), {}

    def step(self, action: int) -> Any:
        self._clock += 1
        return self._shown.copy(), 0.0, False, self._clock == 400, {}


NOTHING = EnvSpec("Nothing-v0", entry_point=Nothing)


def drawn(rows: int) -> Any:
    """Random actions without end, (rows,) ints at a time."""
    return cycle(list(np.random.default_rng(0).integers(0, 6, (400, rows))))


def environment_facts(what: str, group: str) -> dict[str, Any]:
    return {"kind": "environment", "what": what, "group": group}


@pytest.mark.parametrize("what", ["gymnasium.make_vec", "SyncVectorEnv", "SyncVectorEnv that does nothing"])
def test_a_vector_of_30(benchmark, what):
    makers = {
        "gymnasium.make_vec": lambda: gym.make_vec(ID, num_envs=30, partner="stay"),
        "SyncVectorEnv": lambda: SyncVectorEnv([lambda: gym.make(ID)] * 30, autoreset_mode=AutoresetMode.SAME_STEP),
        "SyncVectorEnv that does nothing": lambda: SyncVectorEnv([lambda: gym.make(NOTHING)] * 30),
    }
    envs = makers[what]()
    first, _ = envs.reset(seed=0)
    actions, shown = drawn(30), {}

    def call() -> None:
        shown["last"] = envs.step(next(actions))[0]

    measure(benchmark, call=call, joint_steps=30, **environment_facts(what, VECTOR))
    assert shown["last"].shape == first.shape == (30, *SHAPE)
    assert ("nothing" in what) == (shown["last"] == first).all()
    envs.close()


@pytest.mark.parametrize("what", ["gymnasium.make", "gymnasium.make, doing nothing"])
def test_one_kitchen(benchmark, what):
    env = gym.make(NOTHING if "nothing" in what else ID)
    env.reset(seed=0)
    actions, resets = cycle(np.random.default_rng(0).integers(0, 6, 4000).tolist()), []

    def call() -> None:
        if env.step(next(actions))[3]:
            env.reset()
            resets.append(None)

    measure(benchmark, call=call, joint_steps=1, **environment_facts(what, SINGLE))
    assert resets or not benchmark.stats


@pytest.mark.parametrize("what", ["OvercookedVecEnv(self_play=True)", "DummyVecEnv that does nothing"])
def test_what_stable_baselines3_learns_from(benchmark, what):
    envs: Any = DummyVecEnv([Nothing] * 128) if "nothing" in what else OvercookedVecEnv(LAYOUT, 64, self_play=True)
    envs.seed(0)
    first = envs.reset()
    actions, shown = drawn(128), {}

    def call() -> None:
        shown["last"] = envs.step(next(actions))[0]

    measure(benchmark, call=call, joint_steps=64, **environment_facts(what, LEARNER))
    assert shown["last"].shape == first.shape == (128, *SHAPE)
    assert ("nothing" in what) == (shown["last"] == first).all()
    envs.close()
