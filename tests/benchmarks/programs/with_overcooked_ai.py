"""Joint steps per second of overcooked-ai 1.1.0, one kitchen; see `tests/benchmarks/programs/__init__.py`."""

import json
import sys
import time
from importlib.metadata import version

import numpy as np

np.__dict__["Inf"] = np.inf  # the release was made for numpy 1

from overcooked_ai_py.mdp.actions import Action  # noqa: E402
from overcooked_ai_py.mdp.overcooked_env import OvercookedEnv  # noqa: E402
from overcooked_ai_py.mdp.overcooked_mdp import OvercookedGridworld  # noqa: E402

EPISODE = 400


def rates(seconds: float) -> list[float]:
    env = OvercookedEnv.from_mdp(OvercookedGridworld.from_layout_name("cramped_room"), horizon=EPISODE, info_level=0)
    rng = np.random.default_rng(0)

    def episode() -> None:
        env.reset(regen_mdp=False)
        done = False
        for first, second in rng.integers(0, 6, (EPISODE, 2)):
            state, _, done, _ = env.step((Action.INDEX_TO_ACTION[first], Action.INDEX_TO_ACTION[second]))
            env.lossless_state_encoding_mdp(state)
        assert done

    episode()  # also builds and keeps the motion planner
    found, end = [], time.perf_counter() + seconds
    while time.perf_counter() < end or not found:
        start = time.perf_counter()
        episode()
        found.append(EPISODE / (time.perf_counter() - start))
    return found


assert sys.argv[1] == "1", "it plays one kitchen at a time"
print(json.dumps({"version": version("overcooked-ai"), "rates": {"1": rates(float(sys.argv[2]))}}))
