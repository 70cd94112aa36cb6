"""`Kitchens`: N kitchens of one layout, stepped and observed together."""

from collections.abc import Callable
from contextlib import AbstractContextManager, nullcontext
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen import jit as jitting
from overcooked_bench.kitchen.batch import Batch, Past
from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.kitchen.convert import read_state, write_state
from overcooked_bench.kitchen.events import EVENTS
from overcooked_bench.kitchen.image import paint_kitchen
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import find_observation
from overcooked_bench.kitchen.rules import step_and_note, step_kitchens
from overcooked_bench.kitchen.starts import STARTS, fill_kitchens, start_kitchens, stream_keys
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.kitchen.tables import Tables, compile_tables

_INT64: Final = np.dtype(np.int64)  # comparing with the type itself takes ten times as long
_BOOL: Final = np.dtype(np.bool_)


class StepResult(NamedTuple):
    """The result of one joint step of N kitchens.

    Attributes:
        soup_reward: (N, 2) float64, reward points, for the chef that delivered; the team's reward is the sum.
        partial_reward: (N, 2) float64, 3 / 3 / 5 points, for the chef that earned them.
        truncated: (N,) bool, the horizon is reached.
        events: (N, 2, 25) bool in the order of `EVENTS`, or None if they were not asked for.
        actions_taken: (N, 2) uint16, the actions of each chef, or None if not asked for: one of the bits `POTTED`,
            `PLATED`, `SERVED`, `STARTED`, `TOOK` (with `TOOK_DISH` for a dish), `PICKED_UP`, `PUT_DOWN` and `BLOCKED`
            of `codes`, or 0; `codes.item_of` reads the item concerned.
    """

    soup_reward: NDArray[np.float64]
    partial_reward: NDArray[np.float64]
    truncated: NDArray[np.bool_]
    events: NDArray[np.bool_] | None
    actions_taken: NDArray[np.uint16] | None


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
        actions_taken: Whether `StepResult.actions_taken` is wanted.
        history: Past states to keep; stacked observations need 3.
        autoreset: Whether a kitchen that reaches its horizon starts a new episode within the same step.
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
        actions_taken: bool = False,
        history: int = 0,
        autoreset: bool = True,
    ) -> None:
        self.layout = Layout.load(layout)
        self.cooking = cooking
        self.tables: Tables = compile_tables(self.layout, cooking)
        _expect("num_kitchens", num_kitchens, _is_whole(num_kitchens) and num_kitchens >= 1, "a whole number from 1")
        _expect("horizon", horizon, _is_whole(horizon) and horizon >= 1, "a whole number of steps from 1")
        _expect("start", start, start in STARTS, " or ".join(map(repr, STARTS)))
        _expect("object_probability", object_probability, 0 <= object_probability <= 1, "a probability")
        _expect("history", history, _is_whole(history) and history >= 0, "how many past states to keep, from 0")
        if start == "standard" and not self.layout.start_cells:
            raise WrongUse(
                "start='standard', but the grid names no start cells; mark two with the digits 1 and 2, or use 'random'"
            )
        self.num_kitchens = int(num_kitchens)
        self.horizon = int(horizon)
        self.start = start
        self.object_probability = float(object_probability)
        self.autoreset = autoreset
        self.batch = Batch(num_kitchens, len(self.tables.fresh), len(self.tables.pots))
        self._frames: dict[str, _Frame] = {}
        self._notes = ("events",) * events + ("actions_taken",) * actions_taken
        tables = self.tables
        batch, step_tables = self.batch, (tables.ways, tables.outcomes, tables.by_code, tables.payments, tables.pots)
        self._world = (batch.rows, batch.clock, batch.image, *step_tables, self.horizon)
        self._both = np.tile(np.arange(2), (num_kitchens, 1))
        self._everyone = np.ones(num_kitchens, np.bool_)
        self._past = Past(self.batch, history) if history else None
        self._seeded = False
        self.reset()

    @property
    def history(self) -> int:
        """Past states that are kept."""
        return self._past.history if self._past else 0

    def reset(self, seed: int | NDArray[np.uint64] | None = None, mask: NDArray[np.bool_] | None = None) -> None:
        """Starts new episodes.

        Args:
            seed: Seeds kitchen i's random stream from (seed, i) alone, never from N; an array (N,) of keys gives each
                kitchen its own. None continues the streams (from fresh entropy at first).
            mask: (N,) bool, the kitchens to start; all by default. Not together with a seed.

        Raises:
            ValueError: A negative seed, keys or a mask of a wrong shape or type, or both a seed and a mask.
        """
        if mask is None:
            mask = self._everyone
        elif seed is not None:
            raise WrongUse("give either a seed or a mask: a seed concerns every kitchen")
        elif not isinstance(mask, np.ndarray) or mask.dtype != np.bool_ or mask.shape != (self.num_kitchens,):
            raise WrongUse(f"mask={mask!r}; give a bool array of the shape ({self.num_kitchens},)")
        if seed is not None or not self._seeded:
            self.batch.stream[:, 0] = stream_keys(seed, self.num_kitchens)
            self.batch.stream[:, 1] = 0
            self._seeded = True
        with _quiet():
            batch, tables = self.batch, self.tables
            start_kitchens(
                *(batch.rows, batch.clock, batch.image, batch.stream, mask, tables.fresh, tables.floor, tables.allowed),
                *(
                    tables.standard,
                    tables.pots,
                    tables.by_code,
                    tables.background,
                    self.horizon,
                    self.start == "random",
                ),
            )
            if self.object_probability > 0:
                fill_kitchens(
                    *(batch.rows, batch.image, batch.stream, mask, tables.orders, tables.pots, tables.by_code),
                    *(tables.background, self.horizon, self.object_probability),
                )
        if self._past:
            self._past.restart(self.batch, mask)

    def step(self, actions: ArrayLike) -> StepResult:
        """Plays one joint action in every kitchen.

        Args:
            actions: (N, 2) ints: 0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact.

        Returns:
            The result; a truncated kitchen has already been reset unless `autoreset` is off.

        Raises:
            ValueError: Actions of a wrong shape, type or range, or a kitchen that is over; nothing was played then.
        """
        n, joint = self.num_kitchens, np.asarray(actions)
        if joint.dtype != _INT64 or joint.shape != (n, 2) or not joint.flags.c_contiguous:
            joint = self._checked(joint)
        rewards, truncated, events, taken = np.empty((2, n, 2)), np.empty(n, _BOOL), None, None
        if self._notes:
            events = np.zeros((n, 2, len(EVENTS)), np.bool_) if "events" in self._notes else None
            taken = np.empty((n, 2), np.uint16) if "actions_taken" in self._notes else None
        self.step_into(joint, rewards, truncated, events, taken)
        return StepResult(rewards[0], rewards[1], truncated, events, taken)

    def step_into(
        self,
        actions: NDArray[np.int64],
        rewards: NDArray[np.float64],
        truncated: NDArray[np.bool_],
        events: NDArray[np.bool_] | None = None,
        taken: NDArray[np.uint16] | None = None,
    ) -> int:
        """Steps like `step`, into the caller's arrays, whose shapes and types are not checked.

        Args:
            actions: (N, 2) int64, contiguous.
            rewards: (2, N, 2) float64, contiguous, written: soup rewards, then partial rewards.
            truncated: (N,) bool, written.
            events: (N, 2, 25) bool of zeros, written; by default they are not wanted.
            taken: (N, 2) uint16, written as `StepResult.actions_taken`; by default it is not wanted.

        Returns:
            How many kitchens have reached the horizon.

        Raises:
            ValueError: Actions out of range, or a kitchen that is over; nothing was played then.
        """
        if self._past:
            self._past.remember(self.batch)
        if events is None and taken is None:
            fault, over = step_kitchens(*self._world, actions, rewards, truncated)
        else:
            fault, over = step_and_note(*self._world, actions, rewards, truncated, events, taken)
        if fault >= 0:
            self._raise_fault(fault, actions)
        if self._past:
            self._past.advance()
        if over and self.autoreset:
            self.reset(mask=truncated)
        return int(over)

    def _checked(self, joint: NDArray[Any]) -> NDArray[np.int64]:
        if joint.shape != (self.num_kitchens, 2) or joint.dtype.kind not in "iu":
            raise WrongUse(
                f"actions have the shape {joint.shape} and the type {joint.dtype}; "
                f"give whole numbers of the shape ({self.num_kitchens}, 2)"
            )
        return np.ascontiguousarray(joint, np.int64)

    def _raise_fault(self, kitchen: int, actions: NDArray[np.int64]) -> None:
        if self.batch.clock[kitchen] >= self.horizon:
            raise WrongUse(f"kitchen {kitchen} is over after {self.horizon} steps; call reset() before step()")
        chef = 0 if not 0 <= actions[kitchen, 0] < NUM_ACTIONS else 1
        raise WrongUse(
            f"kitchen {kitchen}, chef {chef}: action {actions[kitchen, chef]}; "
            "actions are 0 north, 1 south, 2 east, 3 west, 4 stay, 5 interact"
        )

    def observe(
        self, name: str, out: NDArray[Any] | None = None, seats: NDArray[np.int64] | None = None
    ) -> NDArray[Any]:
        """Returns the observations of both chefs of every kitchen, or of one of them; changes nothing.

        Args:
            name: One of `observations.registry.OBSERVATIONS`.
            out: A contiguous array of the right shape and type to write into, instead of a fresh one.
            seats: (N,) int64 zeros and ones, for the observation of one chef in each kitchen.

        Returns:
            (N, 2, *observation_shape(name)), uint8, for "features" float32; [:, k] as chef k sees it. With `seats`
            (N, *observation_shape(name)).

        Raises:
            ValueError: An unknown name, "lossless" in a layout with tomatoes, a stack without history, a wrong `out`.
        """
        both, one, dtype, write, prepared, history = self._frames.get(name) or self._frame(name)
        shape = both if seats is None else one
        if out is None:
            out = np.empty(shape, dtype)
        elif out.shape != shape or out.dtype != dtype or not out.flags.c_contiguous:
            raise WrongUse(f"out is {out.dtype} {out.shape}; {name!r} needs a contiguous {dtype} {shape}")
        n = self.num_kitchens
        viewers = self._both if seats is None else seats.reshape(n, 1)
        views = out.reshape(n, viewers.shape[1], -1)
        write(prepared, self.batch, self._past.newest_first() if history and self._past else (), viewers, views)
        return out

    def observe_some(self, name: str, kitchens: NDArray[np.int64], seats: NDArray[np.int64]) -> NDArray[Any]:
        """Returns the observations of some chefs, which takes less time than `observe` if they are few.

        Args:
            name: As for `observe`.
            kitchens: (B,) int64, their kitchens; one may be listed twice.
            seats: (B,) int64, their seats.

        Returns:
            (B, *observation_shape(name)), in memory of its own.

        Raises:
            ValueError: As `observe`.
        """
        _, (_, *shape), dtype, write, prepared, history = self._frames.get(name) or self._frame(name)
        past = self._past.newest_first() if history and self._past else ()
        out = np.empty((len(kitchens), *shape), dtype)
        before = [(rows[kitchens], images[kitchens]) for rows, images in past]
        write(prepared, self.batch.chosen(kitchens), before, seats.reshape(-1, 1), out.reshape(len(kitchens), 1, -1))
        return out

    def _frame(self, name: str) -> "_Frame":
        n, shape, observation = self.num_kitchens, self.observation_shape(name), find_observation(name)
        prepared = observation.prepare(self.layout, self.tables)
        frame = _Frame((n, 2, *shape), (n, *shape), observation.dtype, observation.write, prepared, observation.history)
        self._frames[name] = frame
        return frame

    def observation_shape(self, name: str) -> tuple[int, ...]:
        """Returns the shape of one chef's observation.

        Raises:
            WrongUse: An unknown name, one that this layout cannot be shown in, or a stack without its history.
        """
        observation = find_observation(name)
        if refusal := observation.refuses(self.layout):
            raise WrongUse(refusal)
        if observation.history > self.history:
            raise WrongUse(f"{name!r} needs the past: make Kitchens(..., history={observation.history})")
        return observation.shape(self.layout)

    def state(self, i: int) -> KitchenState:
        """Returns kitchen i in readable form.

        Raises:
            IndexError: There is no kitchen i.
        """
        self._check_index(i)
        return read_state(self.batch, self.tables, self.layout, i)

    def set_state(self, i: int, state: KitchenState) -> None:
        """Puts kitchen i into a state; its history restarts there.

        Raises:
            StateError: The state is not legal here; names the chef or the cell. The kitchen is unchanged then.
        """
        self._check_index(i)
        write_state(self.batch, self.tables, self.layout, i, state, self.horizon)
        tables, batch = self.tables, self.batch
        left = self.horizon - state.timestep
        paint_kitchen(batch.image[i], batch.rows[i], left, tables.background, tables.by_code, tables.pots)
        if self._past:
            mask = np.zeros(self.num_kitchens, np.bool_)
            mask[i] = True
            self._past.restart(self.batch, mask)

    def _check_index(self, i: int) -> None:
        if not 0 <= i < self.num_kitchens:
            raise IndexError(f"kitchen {i}; there are kitchens 0 to {self.num_kitchens - 1}")

    def snapshot(self) -> dict[str, NDArray[Any]]:
        """Returns copies of all arrays of the state, as `restore` takes them."""
        return {name: array.copy() for name, array in self._arrays().items()}

    def restore(self, arrays: dict[str, NDArray[Any]]) -> None:
        """Restores a `snapshot` of kitchens of the same layout, number and history.

        Raises:
            ValueError: The arrays belong to other kitchens; nothing was changed then.
        """
        ours = self._arrays()
        if {k: (v.shape, v.dtype) for k, v in ours.items()} != {k: (v.shape, v.dtype) for k, v in arrays.items()}:
            raise WrongUse("the snapshot was made with another layout, number of kitchens or history")
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
    """An observation of these kitchens: the shapes of both chefs' and of one chef's views, type, who writes them."""

    both: tuple[int, ...]
    one: tuple[int, ...]
    dtype: np.dtype[Any]
    write: Callable[..., None]
    prepared: Any
    history: int


def _quiet() -> AbstractContextManager[Any]:
    """Lets 64-bit counters wrap without a warning if kernels run as plain Python."""
    return np.errstate(over="ignore") if jitting.DISABLED else nullcontext()


def _is_whole(value: object) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def _expect(name: str, value: object, right: bool, wanted: str) -> None:
    if not right:
        raise WrongUse(f"{name}={value!r}; give {wanted}")
