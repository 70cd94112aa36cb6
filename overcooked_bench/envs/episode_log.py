"""Keeps the running episode against partners, so that it can be replayed.

A partner's memory belongs to the partner. An episode is therefore saved as its start and the joint actions since, and
restored by playing these in the kitchens while the partners are shown what they saw then.

Axes: N kitchens, T steps played since the episode began.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.envs.partners import Partners
from overcooked_bench.kitchen.kitchens import Kitchens

Arrays = dict[str, NDArray[Any]]
_WORD: Final = 2**64 - 1


class EpisodeLog:
    """Records how the running episode started and what was played since.

    Attributes:
        seats: (N,) the partners' seats.
    """

    def __init__(self, num_kitchens: int) -> None:
        self._start: Arrays = {}  # empty before the first episode
        self.seats = np.zeros(num_kitchens, np.int64)
        self._seeds = np.zeros(num_kitchens, np.uint64)
        self._played: list[NDArray[np.uint8]] = []

    def begin(self, kitchens: Kitchens, seats: NDArray[np.int64], seeds: NDArray[np.uint64]) -> None:
        """Forgets the last episode; the kitchens are at the start of the next one."""
        self._start, self.seats, self._seeds, self._played = kitchens.snapshot(), seats, seeds, []

    def note(self, joint: NDArray[np.int64]) -> None:
        """Records the joint actions (N, 2) of a step."""
        self._played.append(joint.astype(np.uint8))

    def arrays(self) -> Arrays:
        """Returns the recording as arrays, as `replay` takes them."""
        played = np.stack(self._played) if self._played else np.zeros((0, len(self.seats), 2), np.uint8)
        start = {f"start.{name}": array.copy() for name, array in self._start.items()}
        return {**start, "seats": self.seats.copy(), "seeds": self._seeds.copy(), "played": played}

    def replay(self, arrays: Arrays, kitchens: Kitchens, partners: Partners) -> None:
        """Replays a saved episode up to the step at which it was saved.

        Args:
            arrays: From `arrays`.
            kitchens: Set to the saved state.
            partners: The agents that played then; they are reset, and asked at every step.

        Raises:
            ValueError: The partners act differently now, or the arrays belong to other kitchens.
        """
        start = {name.removeprefix("start."): a for name, a in arrays.items() if name.startswith("start.")}
        self._start, self._played = {}, []
        if not start:
            return
        kitchens.restore(start)
        seats = arrays["seats"].astype(np.int64)
        self.begin(kitchens, seats, arrays["seeds"].astype(np.uint64))
        partners.reset(kitchens, seats, self._seeds)
        rewards, truncated = np.empty((2, *kitchens.batch.clock.shape, 2)), np.empty(len(seats), np.bool_)
        for step, joint in enumerate(arrays["played"].astype(np.int64)):
            answers, recorded = partners.act(kitchens), joint[np.arange(len(seats)), seats]
            if (answers != recorded).any():
                i = int(np.argmax(answers != recorded))
                raise ValueError(
                    f"kitchen {i}, step {step} of the running episode: the partner plays {answers[i]} where it played "
                    f"{recorded[i]} when the snapshot was made; set the same partners, whose actions depend only on "
                    "what reset() passes and on what they observe"
                )
            kitchens.step_into(joint, rewards, truncated)
            self.note(joint)


def generator_state(generator: np.random.Generator) -> NDArray[np.uint64]:
    """Returns a generator's whole state: (6,) uint64."""
    state: Any = generator.bit_generator.state
    words = [word for name in ("state", "inc") for word in divmod(state["state"][name], _WORD + 1)]
    return np.array([*words, state["has_uint32"], state["uinteger"]], np.uint64)


def set_generator_state(generator: np.random.Generator, state: NDArray[Any]) -> None:
    """Sets a generator to what `generator_state` returned."""
    high, low, inc_high, inc_low, has_uint32, uinteger = map(int, state.astype(np.uint64))
    generator.bit_generator.state = {
        "bit_generator": "PCG64",
        "state": {"state": high << 64 | low, "inc": inc_high << 64 | inc_low},
        "has_uint32": has_uint32,
        "uinteger": uinteger,
    }
