import gymnasium as gym
import pytest

from overcooked_bench import parallel_env
from overcooked_bench.envs.sb3 import OvercookedVecEnv

ID = "overcooked_bench:Overcooked/CrampedRoom-v0"
MAKERS = {
    "make": lambda shaping: gym.make(ID, shaping=shaping),
    "make_vec": lambda shaping: gym.make_vec(ID, num_envs=2, shaping=shaping),
    "parallel_env": lambda shaping: parallel_env("cramped_room", shaping=shaping),
    "sb3": lambda shaping: OvercookedVecEnv("cramped_room", 2, shaping=shaping),
    "set_shaping": lambda shaping: OvercookedVecEnv("cramped_room", 2).set_shaping(shaping),
}


@pytest.mark.parametrize("make", MAKERS.values(), ids=MAKERS)
@pytest.mark.parametrize("shaping", [float("nan"), float("inf")])
def test_a_weight_that_is_no_number_is_refused_at_once(make, shaping):
    with pytest.raises(ValueError, match=f"shaping={shaping}; give a finite weight"):
        make(shaping)
