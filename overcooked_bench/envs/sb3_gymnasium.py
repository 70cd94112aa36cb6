"""Environments of `gymnasium.make_vec` for stable-baselines3, which takes only its own kind of vector environment."""

from collections.abc import Sequence
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvIndices, VecEnvObs, VecEnvStepReturn


class GymnasiumVecEnv(VecEnv):
    """A Gymnasium vector environment that stable-baselines3 can learn in.

    `VecMonitor(GymnasiumVecEnv(gym.make_vec("Overcooked/CrampedRoom-v0", num_envs=64)))` also reports returns.

    Args:
        env: An environment that resets each row in the step that ends its episode (`AutoresetMode.SAME_STEP`), as those
            of this package do.

    Attributes:
        env: The environment.

    Raises:
        ValueError: It resets rows otherwise.
    """

    def __init__(self, env: VectorEnv[Any, Any, Any]) -> None:
        if env.metadata.get("autoreset_mode") != AutoresetMode.SAME_STEP:
            raise ValueError(
                f"{env} resets rows in a step of their own; make it with "
                "vector_kwargs={'autoreset_mode': gymnasium.vector.AutoresetMode.SAME_STEP}"
            )
        self.env = env
        self.render_mode = env.render_mode
        self._actions = np.zeros(env.num_envs, np.int64)
        super().__init__(env.num_envs, env.single_observation_space, env.single_action_space)

    def reset(self) -> VecEnvObs:
        """Starts new episodes everywhere: (N, ...) observations; a seed set by `seed` takes effect here."""
        observations, _ = self.env.reset(seed=self._seeds[0])
        self._reset_seeds()
        self._reset_options()
        return np.asarray(observations)

    def step_async(self, actions: NDArray[Any]) -> None:
        """Takes the actions, (N,)."""
        self._actions = actions

    def step_wait(self) -> VecEnvStepReturn:
        """Plays the step: (N, ...) observations, (N,) float32 rewards, (N,) bool and N infos."""
        observations, rewards, terminated, truncated, told = self.env.step(self._actions)
        dones = terminated | truncated
        infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        for i in np.flatnonzero(dones):
            infos[i] = {
                "terminal_observation": told["final_obs"][i],
                "TimeLimit.truncated": bool(truncated[i] and not terminated[i]),
            }
        return np.asarray(observations), rewards.astype(np.float32), dones, infos

    def close(self) -> None:
        """Closes the environment."""
        self.env.close()

    def get_images(self) -> Sequence[NDArray[Any] | None]:
        """Returns a picture of each row."""
        pictures: Any = self.env.render()
        return [None] * self.num_envs if pictures is None else list(pictures)

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Returns an attribute of the environment once for each requested row."""
        return [getattr(self.env, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Sets an attribute of the environment, which all rows share.

        Raises:
            ValueError: Only some rows were named.
        """
        self._need_all(indices)
        setattr(self.env, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: VecEnvIndices = None, **method_kwargs: Any
    ) -> list[Any]:
        """Calls a method of the environment once, and returns its result for each row.

        Raises:
            ValueError: Only some rows were named.
        """
        self._need_all(indices)
        return [getattr(self.env, method_name)(*method_args, **method_kwargs)] * self.num_envs

    def env_is_wrapped(
        self, wrapper_class: type[gym.Wrapper[Any, Any, Any, Any]], indices: VecEnvIndices = None
    ) -> list[bool]:
        """Returns False for each row: its environments are not separate ones that could be wrapped."""
        return [False for _ in self._get_indices(indices)]

    def _need_all(self, indices: VecEnvIndices) -> None:
        if len(set(self._get_indices(indices))) != self.num_envs:
            raise ValueError("the rows share one environment; leave `indices` out to mean all")
