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
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations import (
    CHEF_CHANNELS,
    NUM_CHANNELS,
    ONION_CHANNELS,
    paint_kitchen,
    plane_runs,
    write_chefs,
    write_views,
)
from overcooked_bench.kitchen.rules import Plan, compile_plan, step_kitchens
from overcooked_bench.kitchen.starts import STARTS, fill_kitchens, start_kitchens, stream_keys
from overcooked_bench.kitchen.state import Batch, KitchenState

HISTORY: Final = 3
"""Past states in a stacked observation (thesis, 7.4: the last four states, the current one included)."""

_INT64: Final = np.dtype(np.int64)  # comparing with the type itself takes ten times as long
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
        cooking: "auto" (a pot starts by itself at the third ingredient) or "manual" (an empty-handed interact does it).
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
        _expect("num_kitchens", num_kitchens, _is_whole(num_kitchens) and num_kitchens >= 1, "a whole number from 1")
        _expect("horizon", horizon, _is_whole(horizon) and horizon >= 1, "a whole number of steps from 1")
        _expect("start", start, start in STARTS, " or ".join(map(repr, STARTS)))
        _expect("object_probability", object_probability, 0 <= object_probability <= 1, "a probability")
        _expect("history", history, history in (0, HISTORY), f"0 or {HISTORY}")
        if start == "standard" and not self.layout.start_cells:
            raise ValueError(
                "start='standard', but the grid names no start cells; mark two with the digits 1 and 2, or use 'random'"
            )
        self.num_kitchens = int(num_kitchens)
        self.horizon = int(horizon)
        self.start = start
        self.object_probability = float(object_probability)
        self.autoreset = True
        self.batch = Batch(num_kitchens, len(self.plan.fresh), len(self.plan.pots))
        self._around: NDArray[np.int16] | None = None
        self._frames: dict[str, _Frame] = {}
        self._events = events
        plan = self.plan
        self._tables = (plan.ways, plan.outcomes, plan.by_code, plan.payments, plan.pots)
        self._both = np.tile(np.arange(2), (num_kitchens, 1))
        self._everyone = np.ones(num_kitchens, np.bool_)
        self._past = _Past(self.batch) if history else None
        self._seeded = False
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

        Raises:
            ValueError: A negative seed, keys or a mask of a wrong shape or type, or both a seed and a mask.
        """
        if mask is None:
            mask = self._everyone
        elif seed is not None:
            raise ValueError("give either a seed or a mask: a seed concerns every kitchen")
        elif not isinstance(mask, np.ndarray) or mask.dtype != np.bool_ or mask.shape != (self.num_kitchens,):
            raise ValueError(f"mask={mask!r}; give a bool array of the shape ({self.num_kitchens},)")
        if seed is not None or not self._seeded:
            self.batch.stream[:, 0] = stream_keys(seed, self.num_kitchens)
            self.batch.stream[:, 1] = 0
            self._seeded = True
        with _quiet():
            batch, plan = self.batch, self.plan
            start_kitchens(
                *(batch.rows, batch.clock, batch.image, batch.stream, mask, plan.fresh, plan.floor, plan.allowed),
                *(plan.standard, plan.pots, plan.by_code, plan.background, self.horizon, self.start == "random"),
            )
            if self.object_probability > 0:
                fill_kitchens(
                    *(batch.rows, batch.image, batch.stream, mask, plan.orders, plan.pots, plan.by_code),
                    *(plan.background, self.horizon, self.object_probability),
                )
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
        n, joint = self.num_kitchens, np.asarray(actions)
        if joint.dtype != _INT64 or joint.shape != (n, 2) or not joint.flags.c_contiguous:
            joint = self._checked(joint)
        rewards, truncated = np.empty((2, n, 2)), np.empty(n, np.bool_)
        events = np.zeros((n, 2, len(EVENTS)), np.bool_) if self._events else None
        self.play(joint, rewards, truncated, events)
        return StepResult(rewards[0], rewards[1], truncated, events if self._events else None)

    def play(
        self,
        actions: NDArray[np.int64],
        rewards: NDArray[np.float64],
        truncated: NDArray[np.bool_],
        events: NDArray[np.bool_] | None = None,
    ) -> int:
        """Does what `step` does, into the caller's arrays, whose shapes and types are not checked.

        Args:
            actions: (N, 2) int64, contiguous.
            rewards: (2, N, 2) float64, contiguous, written: soup rewards, then partial rewards.
            truncated: (N,) bool, written.
            events: (N, 2, 25) bool of zeros, written; by default they are not wanted.

        Returns:
            How many kitchens have reached the horizon.

        Raises:
            ValueError: Actions out of range, or a kitchen that is over; nothing was played then.
        """
        batch = self.batch
        if self._past:
            self._past.remember(batch)
        fault, over = step_kitchens(
            *(batch.rows, batch.clock, batch.image, *self._tables, self.horizon, actions, rewards, truncated, events)
        )
        if fault >= 0:
            self._raise_fault(fault, actions)
        if self._past:
            self._past.advance()
        if over and self.autoreset:
            self.reset(mask=truncated)
        return int(over)

    def _checked(self, joint: NDArray[Any]) -> NDArray[np.int64]:
        if joint.shape != (self.num_kitchens, 2) or joint.dtype.kind not in "iu":
            raise ValueError(
                f"actions have the shape {joint.shape} and the type {joint.dtype}; "
                f"give whole numbers of the shape ({self.num_kitchens}, 2)"
            )
        return np.ascontiguousarray(joint, np.int64)

    def _raise_fault(self, kitchen: int, actions: NDArray[np.int64]) -> None:
        if self.batch.clock[kitchen] >= self.horizon:
            raise ValueError(f"kitchen {kitchen} is over after {self.horizon} steps; call reset() before step()")
        chef = 0 if not 0 <= actions[kitchen, 0] < NUM_ACTIONS else 1
        raise ValueError(
            f"kitchen {kitchen}, chef {chef}: action {actions[kitchen, chef]}; "
            "actions are 0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact"
        )

    def observe(
        self, name: str, out: NDArray[Any] | None = None, seats: NDArray[np.int64] | None = None
    ) -> NDArray[Any]:
        """Shows every kitchen as both chefs see it, or as one of them does; changes nothing.

        Args:
            name: One of `OBSERVATIONS`.
            out: A contiguous array of the right shape and type to write into, in place of a fresh one.
            seats: (N,) int64 zeros and ones, for the view of one chef in each kitchen.

        Returns:
            (N, 2, *observation_shape(name)), uint8, for "features" float32; [:, k] as chef k sees it. With `seats`
            (N, *observation_shape(name)).

        Raises:
            ValueError: An unknown name, "lossless" where tomatoes are, a stack without history, a wrong `out`.
        """
        n = self.num_kitchens
        both, one, dtype, runs = self._frames.get(name) or self._frame(name)
        shape = both if seats is None else one
        if out is None:
            out = np.empty(shape, dtype)
        elif out.shape != shape or out.dtype != dtype or not out.flags.c_contiguous:
            raise ValueError(f"out is {out.dtype} {out.shape}; {name!r} needs a contiguous {dtype} {shape}")
        viewers = self._both if seats is None else seats.reshape(n, 1)
        views = out.reshape(n, viewers.shape[1], -1)
        batch = self.batch
        if name == "features":
            if self._around is None:
                self._around = measure(self.layout, self.plan)
            write_features(batch.rows, self.plan.pots, self._around, viewers, views)
            return out
        write_views(batch.rows, batch.image, runs, viewers, views, 0)
        if name in STACKED:
            assert self._past is not None
            for age, (rows, image) in enumerate(self._past.newest_first(), start=1):
                if name == "stack_states":
                    write_views(rows, image, runs, viewers, views, age * _ONION_PLANES)
                else:
                    at = _ONION_PLANES + (age - 1) * CHEF_CHANNELS
                    write_chefs(rows, len(self.plan.fresh), viewers, views, at)
        return out

    def _frame(self, name: str) -> "_Frame":
        n, shape = self.num_kitchens, self.observation_shape(name)
        dtype = np.dtype(np.float32 if name == "features" else np.uint8)
        runs = _LOSSLESS26 if name == "lossless26" else _LOSSLESS
        self._frames[name] = _Frame((n, 2, *shape), (n, *shape), dtype, runs)
        return self._frames[name]

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
        """Gives kitchen i in readable form.

        Raises:
            IndexError: There is no kitchen i.
        """
        self._check_index(i)
        return read_state(self.batch, self.plan, self.layout, i)

    def set_state(self, i: int, state: KitchenState) -> None:
        """Puts kitchen i into a state; its history restarts there.

        Raises:
            ValueError: The state is not legal here; names the chef or the cell. The kitchen is unchanged then.
        """
        self._check_index(i)
        write_state(self.batch, self.plan, self.layout, i, state, self.horizon)
        plan, batch = self.plan, self.batch
        left = self.horizon - state.timestep
        paint_kitchen(batch.image[i], batch.rows[i], left, plan.background, plan.by_code, plan.pots)
        if self._past:
            mask = np.zeros(self.num_kitchens, np.bool_)
            mask[i] = True
            self._past.restart(self.batch, mask)

    def _check_index(self, i: int) -> None:
        if not 0 <= i < self.num_kitchens:
            raise IndexError(f"kitchen {i}; there are kitchens 0 to {self.num_kitchens - 1}")

    def snapshot(self) -> dict[str, NDArray[Any]]:
        """Gives copies of all arrays that the future depends on; `restore` takes them back."""
        return {name: array.copy() for name, array in self._arrays().items()}

    def restore(self, arrays: dict[str, NDArray[Any]]) -> None:
        """Goes back to a `snapshot` of kitchens of the same layout, number and history.

        Raises:
            ValueError: The arrays are those of other kitchens; nothing was changed then.
        """
        ours = self._arrays()
        if {k: (v.shape, v.dtype) for k, v in ours.items()} != {k: (v.shape, v.dtype) for k, v in arrays.items()}:
            raise ValueError("the snapshot was made with another layout, number of kitchens or history")
        for name, array in arrays.items():
            ours[name][...] = array

    def _arrays(self) -> dict[str, NDArray[Any]]:
        batch = self.batch
        arrays: dict[str, NDArray[Any]] = {
            "rows": batch.rows,
            "clock": batch.clock,
            "image": batch.image,
            "stream": batch.stream,
        }
        for age, (rows, image) in enumerate(self._past.newest_first() if self._past else (), start=1):
            arrays |= {f"rows_{age}_ago": rows, f"image_{age}_ago": image}
        return arrays


class _Frame(NamedTuple):
    """What `observe` needs to know of an observation: shapes of both chefs' and of one chef's views, type, planes."""

    both: tuple[int, ...]
    one: tuple[int, ...]
    dtype: np.dtype[Any]
    runs: NDArray[np.int64]


class _Past:
    """The last three states' rows and images, in a ring that all kitchens share, with room for the next one."""

    def __init__(self, batch: Batch) -> None:
        self._ring = [(batch.rows.copy(), batch.image.copy()) for _ in range(HISTORY + 1)]
        self._next = 0

    def remember(self, batch: Batch) -> None:
        """Keeps the present; it becomes the newest past with `advance`."""
        rows, image = self._ring[self._next]
        rows[...], image[...] = batch.rows, batch.image

    def advance(self) -> None:
        self._next = (self._next + 1) % len(self._ring)

    def restart(self, batch: Batch, mask: NDArray[np.bool_]) -> None:
        for rows, image in self._ring:
            rows[mask], image[mask] = batch.rows[mask], batch.image[mask]

    def newest_first(self) -> list[tuple[NDArray[np.uint16], NDArray[np.uint8]]]:
        return [self._ring[self._next - age] for age in range(1, HISTORY + 1)]


def _quiet() -> AbstractContextManager[Any]:
    """Lets 64-bit counters wrap without a warning where kernels run as plain Python."""
    return np.errstate(over="ignore") if jitting.DISABLED else nullcontext()


def _is_whole(value: object) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def _expect(name: str, value: object, right: bool, wanted: str) -> None:
    if not right:
        raise ValueError(f"{name}={value!r}; give {wanted}")
