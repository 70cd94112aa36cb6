"""Many kitchens as one stable-baselines3 `VecEnv`: against partners, or in self-play with both seats as rows.

Axes: N kitchens, R rows that the learner sees (N against partners, 2 N in self-play).
"""

import time
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import gymnasium as gym
import numpy as np
from numpy.typing import NDArray
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env.base_vec_env import VecEnv, VecEnvIndices, VecEnvObs, VecEnvStepReturn

from overcooked_bench.agents.agent import Agent, Reference
from overcooked_bench.envs.episode_log import EpisodeLog, generator_state, set_generator_state
from overcooked_bench.envs.event_rewards import event_weights, shaping_weight
from overcooked_bench.envs.frames import frame
from overcooked_bench.envs.partners import Partners
from overcooked_bench.envs.seats import RANDOM_SEAT, STAY_ACTION, checked_seat
from overcooked_bench.envs.spaces import action_space, observation_space
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import history_for


class OvercookedVecEnv(VecEnv):
    """N kitchens of one layout for stable-baselines3.

    Against partners, row i is the learner in kitchen i. In self-play both seats learn: rows 2k and 2k + 1 are chefs 0
    and 1 of kitchen k. All kitchens start together and reach the horizon together; `infos[i]` is then as a VecMonitor
    and SB3's own vector environments give it (`episode`, `terminal_observation`, `TimeLimit.truncated`), and has the
    team's soup reward of the episode as `episode_soup_reward`; before the horizon all rows share one empty dict.

    Args:
        layout: A shipped name, a grid's text, the path of a `.layout` file, or a Layout.
        num_envs: N.
        partners: What `load_agent` takes, or agents; spread evenly over groups of adjacent kitchens.
        self_play: Both seats are rows; `partners` and `seat` are not used then.
        seat: 0, 1, or "random", drawn for each kitchen and episode.
        observation: A name of `Kitchens.observe`.
        cooking: "auto" or "manual".
        start: "random" or "standard".
        object_probability: Chance of each pot and each pair of hands to be filled at the start.
        horizon: Steps of an episode.
        shaping: Weight of a row's own partial rewards in its reward; `set_shaping` changes it.
        event_rewards: Names of `kitchen.events.EVENTS` to reward points, added to a row's reward whenever its own chef
            causes the event, whatever the shaping; `set_event_share` weakens them.

    Attributes:
        kitchens: The game itself.

    Raises:
        ValueError: An argument is out of range; says what to write instead.
    """

    def __init__(
        self,
        layout: str | Path | Layout,
        num_envs: int,
        *,
        partners: Sequence[Reference | Agent] = ("stay",),
        self_play: bool = False,
        seat: str | int = RANDOM_SEAT,
        observation: str = "lossless",
        cooking: str = "auto",
        start: str = "random",
        object_probability: float = 0.0,
        horizon: int = 400,
        shaping: float = 0.0,
        event_rewards: Mapping[str, float] | None = None,
    ) -> None:
        plan = Layout.load(layout)
        self._seat = checked_seat(seat)
        self._partners = None if self_play else Partners(partners, plan, num_envs)
        self._next_partners: Partners | None = None
        self._event_weights = event_weights(event_rewards) if event_rewards else None
        self._event_share = 1.0
        self.kitchens = Kitchens(
            plan,
            num_envs,
            cooking=cooking,
            horizon=horizon,
            start=start,
            object_probability=object_probability,
            events=self._event_weights is not None,
            history=history_for([observation, *(self._partners.observations if self._partners else ())]),
            autoreset=False,
        )
        if self._partners:
            self._partners.fit(self.kitchens)
        self._observation = observation
        self._shaping = shaping_weight(shaping)
        self._num_kitchens = num_envs
        self._rng = np.random.default_rng()
        self._recording = EpisodeLog(num_envs)
        self._joint = np.full((num_envs, 2), STAY_ACTION, np.int64)
        rows = 2 * num_envs if self_play else num_envs
        self._returns = np.zeros(rows)
        self._soup_returns = np.zeros(num_envs)
        self._rows = np.arange(rows)
        self._nothing_to_tell: list[dict[str, Any]] = [{}] * rows
        self._made = time.time()
        self.render_mode = "rgb_array"
        super().__init__(rows, observation_space(self.kitchens, observation), action_space())

    def set_shaping(self, weight: float) -> None:
        """Sets the weight of partial rewards from the next step on."""
        self._shaping = shaping_weight(weight)

    def set_event_share(self, share: float) -> None:
        """Sets what share of `event_rewards` is paid from the next step on, 1 at first."""
        self._event_share = float(share)

    @property
    def partners(self) -> tuple[Reference | Agent, ...]:
        """The partners of the running episode, as given; none in self-play."""
        return self._partners.given if self._partners else ()

    def set_partners(self, partners: Sequence[Reference | Agent]) -> None:
        """Changes the partners from the next episode on; the running episode ends with the old ones.

        Raises:
            ValueError: In self-play, or what the constructor refuses.
        """
        if not self._partners:
            raise ValueError("in self-play both seats are the learner's; make the environment without self_play")
        chosen = Partners(partners, self.kitchens.layout, self._num_kitchens)
        chosen.fit(self.kitchens)
        self._next_partners = chosen

    def reset(self) -> VecEnvObs:
        """Starts new episodes everywhere: (R, ...) observations.

        A seed set by `seed` takes effect here, and all rows share it; otherwise the random streams continue.
        """
        if self._seeds[0] is None:
            self.kitchens.reset()
        else:
            self._rng = np.random.default_rng(self._seeds[0])
            self.kitchens.reset(seed=int(self._rng.integers(2**63)))
        self._start_episodes()
        self._reset_seeds()
        self._reset_options()
        return self._views()

    def step_async(self, actions: NDArray[np.int64]) -> None:
        """Takes the learner's actions, (R,) ints.

        Raises:
            ValueError: Another shape or type.
        """
        given = np.asarray(actions)
        if given.shape != self._rows.shape or given.dtype.kind not in "iu":
            raise ValueError(
                f"actions have the shape {given.shape} and the type {given.dtype}; "
                f"give whole numbers of the shape {self._rows.shape}"
            )
        self._joint.reshape(-1)[self._rows] = given

    def step_wait(self) -> VecEnvStepReturn:
        """Plays the step.

        Returns:
            (R, ...) observations, (R,) float32 rewards, (R,) bool whether the horizon was reached, and R infos.

        Raises:
            ValueError: An action, of the learner or of a partner, out of range; nothing was played then.
        """
        if self._partners:
            self._joint.reshape(-1)[self._rows ^ 1] = self._partners.act(self.kitchens)
        result = self.kitchens.step(self._joint)
        if self._partners:
            self._recording.note(self._joint)
        soup = result.soup_reward.sum(1)
        rewards = soup[self._rows >> 1] + self._shaping * result.partial_reward.reshape(-1)[self._rows]
        if self._event_weights is not None:
            assert result.events is not None
            paid = self._event_share * self._event_weights
            rewards += result.events.reshape(-1, len(paid))[self._rows] @ paid
        self._returns += rewards
        self._soup_returns += soup
        dones = result.truncated[self._rows >> 1]
        infos = self._finish(dones) if dones.any() else self._nothing_to_tell
        return self._views(), rewards.astype(np.float32), dones, infos

    def snapshot(self) -> dict[str, NDArray[Any]]:
        """Returns the complete state, as arrays.

        Against partners that includes the running episode from its start, since partners keep their own memory.
        """
        arrays = {
            **{f"kitchens.{name}": array for name, array in self.kitchens.snapshot().items()},
            "returns": self._returns.copy(),
            "soup_returns": self._soup_returns.copy(),
            "shaping": np.array(self._shaping),
        }
        if self._partners:
            arrays |= {f"episode.{name}": array for name, array in self._recording.arrays().items()}
            arrays["random"] = generator_state(self._rng)
        return arrays

    def restore(self, arrays: dict[str, NDArray[Any]]) -> None:
        """Restores a `snapshot`; a seed that waits for the next reset is dropped.

        Against partners, first set those that played then (the constructor's, or `set_partners`, which takes effect
        immediately here): they are reset as at the start of the saved episode and replay it. Their actions must depend
        only on what `reset` passes and on what they observe.

        Raises:
            ValueError: The snapshot is of another environment, other partners play, or a kitchen was set to a state
                within the episode. Call `reset` before playing on after that.
        """
        if ("random" in arrays) != bool(self._partners):
            theirs, ours = (
                ("with partners", "in self-play") if "random" in arrays else ("in self-play", "with partners")
            )
            raise ValueError(f"the snapshot was made {theirs}, and this environment is {ours}")
        kitchens = _within("kitchens.", arrays)
        self.kitchens.restore(kitchens)
        if self._partners:
            self._partners, self._next_partners = self._next_partners or self._partners, None
            self._recording.replay(_within("episode.", arrays), self.kitchens, self._partners)
            if any((array != kitchens[name]).any() for name, array in self.kitchens.snapshot().items()):
                raise ValueError("a kitchen was set to a state within the episode, which cannot be played again")
            self._rows = 2 * np.arange(self._num_kitchens) + 1 - self._recording.seats
            set_generator_state(self._rng, arrays["random"])
        self._returns[...] = arrays["returns"]
        self._soup_returns[...] = arrays["soup_returns"]
        self._shaping = float(arrays["shaping"])
        self._reset_seeds()

    def _finish(self, dones: NDArray[np.bool_]) -> list[dict[str, Any]]:
        if not dones.all():
            raise RuntimeError("only some kitchens are over; episodes of one OvercookedVecEnv start and end together")
        last = self._views()
        seconds = round(time.time() - self._made, 6)
        infos = [
            {
                "episode": {"r": float(total), "l": self.kitchens.horizon, "t": seconds},
                "episode_soup_reward": float(self._soup_returns[row >> 1]),
                "terminal_observation": last[k],
                "TimeLimit.truncated": True,
            }
            for k, (row, total) in enumerate(zip(self._rows, self._returns, strict=True))
        ]
        self.kitchens.reset()
        self._start_episodes()
        return infos

    def _start_episodes(self) -> None:
        self._returns[:] = 0
        self._soup_returns[:] = 0
        if self._partners:
            self._partners, self._next_partners = self._next_partners or self._partners, None
            n = self._num_kitchens
            drawn = self._rng.integers(2, size=n)
            seats = drawn if self._seat == RANDOM_SEAT else np.full(n, self._seat)
            self._rows = 2 * np.arange(n) + seats
            seeds = self._rng.integers(2**63, size=n).astype(np.uint64)
            self._recording.begin(self.kitchens, 1 - seats, seeds)
            self._partners.reset(self.kitchens, 1 - seats, seeds)

    def _views(self) -> NDArray[Any]:
        if self._partners:
            return self.kitchens.observe(self._observation, seats=self._rows & 1)
        views = self.kitchens.observe(self._observation)
        return views.reshape(-1, *views.shape[2:])

    def get_images(self) -> Sequence[NDArray[Any] | None]:
        """Draws every kitchen: N pictures (h, w, 3) uint8."""
        return [frame(self.kitchens, i, "rgb_array") for i in range(self._num_kitchens)]

    def close(self) -> None:
        """Does nothing: there is nothing to release."""

    def get_attr(self, attr_name: str, indices: VecEnvIndices = None) -> list[Any]:
        """Returns an attribute once for each requested row; all rows share this environment."""
        return [getattr(self, attr_name) for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: VecEnvIndices = None) -> None:
        """Sets an attribute for all rows.

        Raises:
            ValueError: Only some rows were named.
        """
        self._need_all(indices)
        setattr(self, attr_name, value)

    def env_method(
        self, method_name: str, *method_args: Any, indices: VecEnvIndices = None, **method_kwargs: Any
    ) -> list[Any]:
        """Calls a method of this environment once, and returns its result for each row.

        Raises:
            ValueError: Only some rows were named.
        """
        self._need_all(indices)
        result = getattr(self, method_name)(*method_args, **method_kwargs)
        return [result] * self.num_envs

    def env_is_wrapped(
        self, wrapper_class: type[gym.Wrapper[Any, Any, Any, Any]], indices: VecEnvIndices = None
    ) -> list[bool]:
        """Returns whether rows are wrapped: only in a Monitor, as the infos contain its values already."""
        return [wrapper_class is Monitor for _ in self._get_indices(indices)]

    def _need_all(self, indices: VecEnvIndices) -> None:
        chosen: Iterable[int] = self._get_indices(indices)
        if len(set(chosen)) != self.num_envs:
            raise ValueError("rows of one OvercookedVecEnv share one environment; leave `indices` out to mean all")


def _within(prefix: str, arrays: dict[str, NDArray[Any]]) -> dict[str, NDArray[Any]]:
    return {name.removeprefix(prefix): array for name, array in arrays.items() if name.startswith(prefix)}
