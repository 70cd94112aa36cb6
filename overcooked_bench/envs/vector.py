"""Many kitchens as one `gymnasium.vector.VectorEnv`.

Axes: N kitchens.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
from gymnasium.error import ResetNeeded
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.agents.agent import Agent, Reference
from overcooked_bench.agents.seated import Views
from overcooked_bench.envs.event_rewards import shaping_weight
from overcooked_bench.envs.frames import RENDER_FPS, RENDER_MODES, checked_mode, frame
from overcooked_bench.envs.seats import (
    LARGEST_DRAW,
    RANDOM_SEAT,
    STAY_ACTION,
    checked_seat,
    needed_layout,
    seat_partner,
)
from overcooked_bench.envs.spaces import action_space, observation_space
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import history_for


class OvercookedVectorEnv(VectorEnv[NDArray[Any], NDArray[Any], NDArray[Any]]):
    """N kitchens of one layout, stepped as one batch; `gymnasium.make_vec` makes it.

    Kitchen i plays exactly as `OvercookedEnv` does with its seed: `reset(seed=s)` gives kitchen i the seed s + i, as
    Gymnasium's own vector environments do. A kitchen that reaches its horizon is reset within the same step
    (`AutoresetMode.SAME_STEP`): `infos["final_obs"]` and `infos["final_info"]` then hold its last observation and
    information, and its row of everything else already belongs to the next episode.

    `reset(options={"reset_mask": mask})` restarts some kitchens, with the partner "stay" only: other partners are
    asked once for all kitchens, whose episodes therefore start together.

    Args:
        layout: A shipped name, a grid's text, the path of a `.layout` file, or a Layout.
        num_envs: N.
        max_episode_steps: The horizon where it is shorter than `horizon`.
        partner: As in `OvercookedEnv`, like all that follow; one agent serves all kitchens.
        seat: 0, 1, or "random", drawn for each kitchen and episode.
        observation: A name of `Kitchens.observe`.
        cooking: "auto" or "manual".
        start: "random" or "standard".
        object_probability: Chance of each pot and each pair of hands to be filled at the start.
        horizon: Steps of an episode.
        shaping: Weight of the ego agents' partial rewards in the rewards.
        render_mode: "rgb_array", "ansi" or None; `render` then gives one frame for each kitchen.

    Attributes:
        kitchens: The game itself.

    Raises:
        ValueError: An argument is out of range; says what to write instead.
    """

    metadata: ClassVar[dict[str, Any]] = {  # type: ignore[misc]
        "render_modes": list(RENDER_MODES),
        "render_fps": RENDER_FPS,
        "autoreset_mode": AutoresetMode.SAME_STEP,
    }

    def __init__(
        self,
        layout: str | Path | Layout | None = None,
        num_envs: int = 1,
        *,
        max_episode_steps: int | None = None,
        partner: Reference | Agent = "stay",
        seat: str | int = RANDOM_SEAT,
        observation: str = "lossless",
        cooking: str = "auto",
        start: str = "random",
        object_probability: float = 0.0,
        horizon: int = 400,
        shaping: float = 0.0,
        render_mode: str | None = None,
    ) -> None:
        plan = needed_layout(layout)
        self._chosen_seat = checked_seat(seat)
        self.render_mode = checked_mode(render_mode)
        self._partner = seat_partner(partner, plan, num_envs)
        self.kitchens = Kitchens(
            plan,
            num_envs,
            cooking=cooking,
            horizon=horizon if max_episode_steps is None else min(horizon, max_episode_steps),
            start=start,
            object_probability=object_probability,
            history=history_for([observation, self._partner.observation if self._partner else ""]),
            autoreset=False,
        )
        if self._partner:
            self._partner.fit(self.kitchens)
        self.num_envs = num_envs
        self.single_action_space = action_space()
        self.action_space = batch_space(self.single_action_space, num_envs)
        self.single_observation_space = observation_space(self.kitchens, observation)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self._observation = observation
        self._shaping = shaping_weight(shaping)
        self._streams: list[np.random.Generator] = []
        self._stream_seeds: list[int] = []
        self._started = False
        self._everyone = np.ones(num_envs, np.bool_)
        self._everyone.flags.writeable = False
        self._first_rows = 2 * np.arange(num_envs)
        self._seats = np.zeros(num_envs, np.int64)
        self._rows = self._first_rows.copy()  # where the ego agents' entries are among 2N
        self._joint = np.full((num_envs, 2), STAY_ACTION, np.int64)
        self._rewards = np.zeros((2, num_envs, 2))
        self._set_views()

    def __setstate__(self, state: dict[str, Any]) -> None:
        """Completes a copy: what was a view of an array becomes a view of the copied array."""
        self.__dict__.update(state)
        self._set_views()

    def _set_views(self) -> None:
        self._flat_joint = self._joint.reshape(-1)
        self._soup_0, self._soup_1 = self._rewards[0].T
        self._partial = self._rewards[1].reshape(-1)

    @property  # type: ignore[misc]
    def np_random(self) -> tuple[np.random.Generator, ...]:  # type: ignore[override]
        """The generator of each kitchen's seats, start states and partner."""
        self._seed_streams(None)
        return tuple(self._streams)

    @property
    def np_random_seed(self) -> tuple[int, ...]:  # type: ignore[override]
        """The seed of each kitchen."""
        self._seed_streams(None)
        return tuple(self._stream_seeds)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[Any], dict[str, Any]]:
        """Starts new episodes.

        Args:
            seed: Seeds all randomness of kitchen i with seed + i, or with the i-th seed of a list.
            options: {"reset_mask": (N,) bool} to reset some kitchens only, without a seed.

        Returns:
            (N, ...) observations, and arrays (N,) `soup_reward`, `partial_reward` (zeros) and `seat`, each with a mask
            `_key` of the kitchens that were reset.

        Raises:
            ValueError: A wrong seed or mask, or a mask where the partner is not "stay".
        """
        mask = self._checked_mask(options, seed)
        if seed is not None or not self._started:
            self._seed_streams(seed)
            mask, self._started = self._everyone, True
            self.kitchens.reset(np.array([stream.integers(LARGEST_DRAW) for stream in self._streams], np.uint64))
        else:
            self.kitchens.reset(mask=mask)
        self._start_episodes(mask)
        nothing = np.zeros(self.num_envs)
        return self._observe(), self._information(nothing, nothing.copy(), np.where(mask, self._seats, 0), mask)

    def step(
        self, actions: ArrayLike
    ) -> tuple[NDArray[Any], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Plays one step in every kitchen.

        Args:
            actions: (N,) whole numbers from 0 to 5, the ego agents'.

        Returns:
            (N, ...) observations, (N,) rewards, (N,) False, (N,) whether the horizon was reached, and information:
            `soup_reward`, `partial_reward` and `seat` with their masks; at the horizon also `final_obs` and
            `final_info`. All arrays are fresh but the masks of the first three, which cannot be written.

        Raises:
            ResetNeeded: `reset` was never called.
            ValueError: Actions of a wrong shape, type or range.
        """
        if not self._started:
            raise ResetNeeded("call reset() before the first step()")
        given = np.asarray(actions)
        if given.shape != self._everyone.shape or given.dtype.kind not in "iu":
            raise ValueError(
                f"actions have the shape {given.shape} and the type {given.dtype}; "
                f"give whole numbers of the shape ({self.num_envs},)"
            )
        self._flat_joint[self._rows] = given
        if self._partner:
            views = Views(self.kitchens, self._partner.seats)
            self._flat_joint[self._rows ^ 1] = self._partner.act(views.of(self._partner))
        truncated = np.empty(self.num_envs, np.bool_)
        over = self.kitchens.step_into(self._joint, self._rewards, truncated)
        soup = self._soup_0 + self._soup_1
        partial = self._partial[self._rows]
        reward = soup + self._shaping * partial if self._shaping else soup.copy()
        if over:
            infos = self._finish(truncated, soup, partial)
        else:
            infos = self._information(soup, partial, self._seats, self._everyone)
        return self._observe(), reward, np.zeros(self.num_envs, np.bool_), truncated, infos

    def render(self) -> tuple[Any, ...] | None:
        """Shows every kitchen as it is now: a tuple of N pictures (h, w, 3) uint8, or of N texts."""
        if self.render_mode is None:
            return None
        return tuple(frame(self.kitchens, i, self.render_mode) for i in range(self.num_envs))

    def _observe(self) -> NDArray[Any]:
        return self.kitchens.observe(self._observation, None, self._seats)

    def _information(
        self, soup: NDArray[np.float64], partial: NDArray[np.float64], seats: NDArray[np.int64], mask: NDArray[np.bool_]
    ) -> dict[str, Any]:
        return {
            "soup_reward": soup,
            "_soup_reward": mask,
            "partial_reward": partial,
            "_partial_reward": mask,
            "seat": seats.copy(),
            "_seat": mask,
        }

    def _finish(
        self, over: NDArray[np.bool_], soup: NDArray[np.float64], partial: NDArray[np.float64]
    ) -> dict[str, Any]:
        """Resets the kitchens that are over, and returns their last observations and information."""
        if self._partner and not over.all():
            raise RuntimeError(
                f"{np.count_nonzero(over)} of {self.num_envs} kitchens are over and the others are not, yet this "
                "partner's episodes must start together; set_state() on all kitchens with one timestep, or use "
                "partner='stay'"
            )
        last, final_obs = self._observe(), np.full(self.num_envs, None, object)
        for i in np.flatnonzero(over):
            final_obs[i] = last[i].copy()
        final_info = self._information(
            np.where(over, soup, 0.0), np.where(over, partial, 0.0), np.where(over, self._seats, 0), over.copy()
        )
        self.kitchens.reset(mask=over)
        self._start_episodes(over)
        return {
            **self._information(np.where(over, 0.0, soup), np.where(over, 0.0, partial), self._seats, self._everyone),
            "final_obs": final_obs,
            "_final_obs": over.copy(),
            "final_info": final_info,
            "_final_info": over.copy(),
        }

    def _start_episodes(self, mask: NDArray[np.bool_]) -> None:
        """Draws seats and partners' seeds for the kitchens that start."""
        drawn = self._chosen_seat == RANDOM_SEAT
        if drawn or self._partner:
            draws = np.zeros(self.num_envs, np.int64)
            for i in np.flatnonzero(mask):
                draws[i] = self._streams[i].integers(LARGEST_DRAW)
        seats = (draws & 1) if drawn else np.int64(self._chosen_seat)
        self._seats = np.where(mask, seats, self._seats)
        self._rows = self._first_rows + self._seats
        self._joint[:] = STAY_ACTION
        if self._partner:
            self._partner.reset(self.kitchens.layout.name, (draws >> 1).astype(np.uint64), 1 - self._seats)

    def _seed_streams(self, seed: int | Sequence[int | None] | None) -> None:
        if seed is None and self._streams:
            return
        seeds: Sequence[int | None]
        if seed is None:
            seeds = [None] * self.num_envs
        elif isinstance(seed, int | np.integer):
            seeds = [int(seed) + i for i in range(self.num_envs)]
        else:
            seeds = seed
        if len(seeds) != self.num_envs:
            raise ValueError(
                f"{len(seeds)} seeds for {self.num_envs} kitchens; give one number, or a list of one for each"
            )
        drawn = [seeding.np_random(one) for one in seeds]
        self._streams, self._stream_seeds = [stream for stream, _ in drawn], [used for _, used in drawn]

    def _checked_mask(self, options: dict[str, Any] | None, seed: object) -> NDArray[np.bool_]:
        mask = (options or {}).get("reset_mask")
        if mask is None:
            return self._everyone
        if (
            not isinstance(mask, np.ndarray)
            or mask.shape != (self.num_envs,)
            or mask.dtype != np.bool_
            or not mask.any()
        ):
            raise ValueError(
                f"options['reset_mask']={mask!r}; "
                f"give a bool array of the shape ({self.num_envs},) with at least one True"
            )
        if seed is not None:
            raise ValueError("give either a seed or options['reset_mask']: a seed concerns every kitchen")
        if self._partner and not mask.all():
            raise ValueError(
                "options['reset_mask'] leaves kitchens out, yet this partner's episodes must start together; "
                "reset all kitchens, or use partner='stay'"
            )
        return mask.copy()
