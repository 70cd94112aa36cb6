"""`Kitchens`: N kitchens of one layout, stepped and observed together."""

from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.kitchen import jit as jitting
from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.kitchen.convert import read_state, write_state
from overcooked_bench.kitchen.events import EVENTS
from overcooked_bench.kitchen.features import NUM_FEATURES, measure, write_features
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations import (
    CHEF_CHANNELS,
    NUM_CHANNELS,
    ONION_CHANNELS,
    URGENT_STEPS,
    paint_kitchen,
    paint_urgency,
    plane_runs,
    write_chefs,
    write_views,
)
from overcooked_bench.kitchen.rules import Plan, compile_plan, step_kitchen
from overcooked_bench.kitchen.starts import STARTS, start_kitchen, stream_keys
from overcooked_bench.kitchen.state import Batch, KitchenState

HISTORY: Final = 3
"""Past states in a stacked observation (thesis, 7.4: the last four states, the current one included)."""

_LOSSLESS, _LOSSLESS26 = plane_runs(ONION_CHANNELS), plane_runs(tuple(range(NUM_CHANNELS)))
_ONION_PLANES = len(ONION_CHANNELS)
GRID_PLANES: Final = {
    "lossless": (_ONION_PLANES,),
    "lossless26": (NUM_CHANNELS,),
    "stack_channels": (_ONION_PLANES + HISTORY * CHEF_CHANNELS,),
    "stack_states": (1 + HISTORY, _ONION_PLANES),
}
"""Leading axes of the grid observations; (H, W) follow."""

OBSERVATIONS: Final = (*GRID_PLANES, "features")
STACKED: Final = ("stack_channels", "stack_states")


class StepResult(NamedTuple):
    """What one joint step brought, for N kitchens.

    Attributes:
        soup_reward: (N, 2) float64, reward points, for the chef who delivered; the team's reward is the sum.
        partial_reward: (N, 2) float64, 3 / 3 / 5 points, for the chef who earned them.
        truncated: (N,) bool, the horizon is reached.
        events: (N, 2, 25) bool in the order of `EVENTS`, or None where they were not asked for.
    """

    soup_reward: NDArray[np.float64]
    partial_reward: NDArray[np.float64]
    truncated: NDArray[np.bool_]
    events: NDArray[np.bool_] | None


class Kitchens:
    """N kitchens of one layout.

    Args:
        layout: A shipped name, a grid's text, a `.layout` file or a Layout.
        num_kitchens: N.
        cooking: "auto" (a pot starts by itself at the third ingredient) or "manual" (an empty-handed interact starts it).
        horizon: Steps of an episode.
        start: "random" or "standard".
        object_probability: Chance of each pot and each pair of hands to be filled at the start.
        events: Whether `StepResult.events` is wanted.
        history: 3 to keep the past states that stacked observations need, else 0.

    Attributes:
        autoreset: Whether a kitchen that reaches its horizon starts anew within the same step; true by default.
    """

    def __init__(
        self,
        layout: str | Path | Layout,
        num_kitchens: int,
        *,
        cooking: str = "auto",
        horizon: int = 400,
        start: str = "random",
        object_probability: float = 0.0,
        events: bool = False,
        history: int = 0,
    ) -> None:
        self.layout = Layout.load(layout)
        self.cooking = cooking
        self.plan: Plan = compile_plan(self.layout, cooking)
        _expect("num_kitchens", num_kitchens, num_kitchens >= 1, "a number from 1")
        _expect("horizon", horizon, horizon >= 1, "a number of steps from 1")
        _expect("start", start, start in STARTS, " or ".join(map(repr, STARTS)))
        _expect("object_probability", object_probability, 0 <= object_probability <= 1, "a probability")
        _expect("history", history, history in (0, HISTORY), f"0 or {HISTORY}")
        if start == "standard" and not self.layout.start_cells:
            raise ValueError(
                "start='standard', but the grid names no start cells; mark two floor cells with 1 and 2, or use 'random'"
            )
        self.num_kitchens = num_kitchens
        self.horizon = horizon
        self.start = start
        self.object_probability = float(object_probability)
        self.autoreset = True
        cells = len(self.plan.fresh_cells)
        self.batch = Batch(
            cells=np.zeros((num_kitchens, cells), np.uint8),
            remaining=np.zeros((num_kitchens, len(self.plan.pots)), np.uint8),
            position=np.zeros((num_kitchens, 2), np.int16),
            facing=np.zeros((num_kitchens, 2), np.uint8),
            held=np.zeros((num_kitchens, 2), np.uint8),
            timestep=np.zeros(num_kitchens, np.int64),
            stream=np.zeros((num_kitchens, 2), np.uint64),
            image=np.zeros((num_kitchens, NUM_CHANNELS, cells), np.uint8),
        )
        self._near = None
        self._events = events
        self._no_events = np.zeros((num_kitchens, 0, len(EVENTS)), np.bool_)
        self._everyone = np.ones(num_kitchens, np.bool_)
        self._past = _Past(self.batch) if history else None
        self.reset()

    @property
    def history(self) -> int:
        """Past states that are kept."""
        return HISTORY if self._past else 0

    def reset(self, seed: int | NDArray[np.uint64] | None = None, mask: NDArray[np.bool_] | None = None) -> None:
        """Starts new episodes.

        Args:
            seed: Starts kitchen i's random stream anew from (seed, i) alone, never from N; an array (N,) of keys gives
                each kitchen its own. None goes on with the streams as they are (from fresh entropy at first).
            mask: (N,) bool, the kitchens to start; all by default. Not together with a seed.
        """
        if seed is not None or not self.batch.stream[0, 0]:
            if mask is not None:
                raise ValueError("give either a seed or a mask: a seed concerns every kitchen")
            self.batch.stream[:, 0] = stream_keys(seed, self.num_kitchens)
            self.batch.stream[:, 1] = 0
        mask = self._everyone if mask is None else np.ascontiguousarray(mask, np.bool_)
        with _quiet():
            _start_masked(self.batch, self.plan, mask, self.start == "random", self.object_probability, self.horizon)
        if self._past:
            self._past.restart(self.batch, mask)

    def step(self, actions: ArrayLike) -> StepResult:
        """Plays one joint action in every kitchen.

        Args:
            actions: (N, 2) ints: 0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact.

        Returns:
            Rewards, truncation and events; a truncated kitchen has already been reset unless `autoreset` is off.

        Raises:
            ValueError: Actions of a wrong shape, type or range, or a kitchen that is over; nothing was played then.
        """
        given = np.asarray(actions)
        if given.shape != (self.num_kitchens, 2) or given.dtype.kind not in "iu":
            raise ValueError(
                f"actions have the shape {given.shape} and the type {given.dtype}; "
                f"give whole numbers of the shape ({self.num_kitchens}, 2)"
            )
        joint = np.ascontiguousarray(given, np.int64)
        n = self.num_kitchens
        soup_reward, partial_reward = np.empty((n, 2)), np.empty((n, 2))
        truncated = np.empty(n, np.bool_)
        events = np.zeros((n, 2, len(EVENTS)), np.bool_) if self._events else self._no_events
        if self._past:
            fault = _find_fault(self.batch, joint, self.horizon)
            if fault < 0:
                self._past.remember(self.batch)
        with _quiet():
            fault, over = _step_all(
                *(self.batch, self.plan, joint, soup_reward, partial_reward, truncated, events),
                self.horizon,
            )
        if fault >= 0:
            self._raise_fault(fault, joint)
        if self.autoreset and over:
            self.reset(mask=truncated)
        return StepResult(soup_reward, partial_reward, truncated, events if self._events else None)

    def _raise_fault(self, kitchen: int, actions: NDArray[np.int64]) -> None:
        if self.batch.timestep[kitchen] >= self.horizon:
            raise ValueError(f"kitchen {kitchen} is over after {self.horizon} steps; call reset() before step()")
        chef = 0 if not 0 <= actions[kitchen, 0] < NUM_ACTIONS else 1
        raise ValueError(
            f"kitchen {kitchen}, chef {chef}: action {actions[kitchen, chef]}; "
            "actions are 0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact"
        )

    def observe(self, name: str, out: NDArray[Any] | None = None) -> NDArray[Any]:
        """Shows every kitchen as both chefs see it; changes nothing.

        Args:
            name: One of `OBSERVATIONS`.
            out: A contiguous array of the right shape and type to write into, in place of a fresh one.

        Returns:
            (N, 2, *observation_shape(name)), uint8, for "features" float32; [:, k] as chef k sees it.

        Raises:
            ValueError: An unknown name, "lossless" where tomatoes are, a stack without history, a wrong `out`.
        """
        shape = (self.num_kitchens, 2, *self.observation_shape(name))
        dtype = np.float32 if name == "features" else np.uint8
        if out is None:
            out = np.empty(shape, dtype)
        elif out.shape != shape or out.dtype != dtype or not out.flags.c_contiguous:
            raise ValueError(f"out is {out.dtype} {out.shape}; {name!r} needs a contiguous {np.dtype(dtype)} {shape}")
        batch = self.batch
        if name == "features":
            if self._near is None:
                self._near = measure(self.layout, self.plan)
            write_features(batch, self.plan, self._near, out)
            return out
        views = out.reshape(self.num_kitchens, 2, -1, len(self.plan.fresh_cells))
        runs = _LOSSLESS26 if name == "lossless26" else _LOSSLESS
        write_views(batch.image, batch.position, batch.facing, runs, views, 0)
        if name in STACKED:
            assert self._past is not None
            if name == "stack_channels":
                views[:, :, _ONION_PLANES:] = 0
            for age, (image, position, facing) in enumerate(self._past.newest_first(), start=1):
                if name == "stack_states":
                    write_views(image, position, facing, runs, views, age * _ONION_PLANES)
                else:
                    write_chefs(position, facing, views, _ONION_PLANES + (age - 1) * CHEF_CHANNELS)
        return out

    def observation_shape(self, name: str) -> tuple[int, ...]:
        """Gives the shape of one chef's observation.

        Raises:
            ValueError: An unknown name, "lossless" where tomatoes are, or a stack without history.
        """
        if name not in OBSERVATIONS:
            raise ValueError(f"no observation named {name!r}; choose one of {', '.join(OBSERVATIONS)}")
        if name == "features":
            return (NUM_FEATURES,)
        if name != "lossless26" and self.layout.has_tomatoes:
            raise ValueError(f"{name!r} has no tomato channels, and this layout has tomatoes; use 'lossless26'")
        if name in STACKED and not self._past:
            raise ValueError(f"{name!r} needs the past: make Kitchens(..., history={HISTORY})")
        return (*GRID_PLANES[name], self.layout.height, self.layout.width)

    def state(self, i: int) -> KitchenState:
        """Gives kitchen i in readable form."""
        return read_state(self.batch, self.plan, self.layout, i)

    def set_state(self, i: int, state: KitchenState) -> None:
        """Puts kitchen i into a state; its history restarts there.

        Raises:
            ValueError: The state is not legal here; names the chef or the cell. The kitchen is unchanged then.
        """
        write_state(self.batch, self.plan, self.layout, i, state, self.horizon)
        paint_kitchen(
            *(self.batch.image[i], self.batch.cells[i], self.batch.remaining[i], self.batch.position[i]),
            *(self.batch.held[i], self.horizon - state.timestep),
            *(self.plan.background, self.plan.pot_at, self.plan.paint),
        )
        if self._past:
            mask = np.zeros(self.num_kitchens, np.bool_)
            mask[i] = True
            self._past.restart(self.batch, mask)


class _Past:
    """The last three states' images and chefs, in a ring that all kitchens share."""

    def __init__(self, batch: Batch) -> None:
        self._ring = [(batch.image.copy(), batch.position.copy(), batch.facing.copy()) for _ in range(HISTORY)]
        self._oldest = 0

    def remember(self, batch: Batch) -> None:
        image, position, facing = self._ring[self._oldest]
        image[...], position[...], facing[...] = batch.image, batch.position, batch.facing
        self._oldest = (self._oldest + 1) % HISTORY

    def restart(self, batch: Batch, mask: NDArray[np.bool_]) -> None:
        for image, position, facing in self._ring:
            image[mask], position[mask], facing[mask] = batch.image[mask], batch.position[mask], batch.facing[mask]

    def newest_first(self) -> list[tuple[NDArray[np.uint8], NDArray[np.int16], NDArray[np.uint8]]]:
        return [self._ring[(self._oldest - age) % HISTORY] for age in range(1, HISTORY + 1)]


@jit
def _find_fault(batch: Batch, actions: NDArray[np.int64], horizon: int) -> int:
    """Gives the first kitchen that cannot be stepped, or -1."""
    for i in range(actions.shape[0]):
        if batch.timestep[i] >= horizon:
            return i
        for chef in range(2):
            if actions[i, chef] < 0 or actions[i, chef] >= NUM_ACTIONS:
                return i
    return -1


@jit
def _step_all(
    batch: Batch,
    plan: Plan,
    actions: NDArray[np.int64],
    soup_reward: NDArray[np.float64],
    partial_reward: NDArray[np.float64],
    truncated: NDArray[np.bool_],
    events: NDArray[np.bool_],
    horizon: int,
) -> tuple[int, int]:
    """Steps every kitchen; gives the first that cannot be stepped, or -1, and how many are over now.

    Where one cannot be stepped, nothing was done.
    """
    fault, over = _find_fault(batch, actions, horizon), 0
    if fault >= 0:
        return fault, over
    for i in range(actions.shape[0]):
        step_kitchen(batch, plan, i, actions[i], soup_reward[i], partial_reward[i], events[i])
        left = horizon - batch.timestep[i]
        truncated[i] = left <= 0
        over += left <= 0
        if left == URGENT_STEPS - 1:
            paint_urgency(batch.image[i])
    return -1, over


@jit
def _start_masked(
    batch: Batch, plan: Plan, mask: NDArray[np.bool_], random: bool, object_probability: float, horizon: int
) -> None:
    for i in range(mask.shape[0]):
        if mask[i]:
            start_kitchen(batch, plan, i, random, object_probability, horizon)


def _quiet() -> AbstractContextManager[Any]:
    """Lets 64-bit counters wrap without a warning where kernels run as plain Python."""
    return np.errstate(over="ignore") if jitting.DISABLED else nullcontext()


def _expect(name: str, value: object, right: bool, wanted: str) -> None:
    if not right:
        raise ValueError(f"{name}={value!r}; give {wanted}")
