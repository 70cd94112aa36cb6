"""The running episode against partners, kept so that it can be played again.

What a partner remembers is its own. An episode is therefore saved as its start and the joint actions since, and brought
back by playing these through the kitchens while the partners are asked what they were asked then.

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
    """How the running episode began and what was played since.

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
        """Notes the joint actions (N, 2) of a step."""
        self._played.append(joint.astype(np.uint8))

    def arrays(self) -> Arrays:
        """Gives the recording as arrays; `replay` takes them back."""
        played = np.stack(self._played) if self._played else np.zeros((0, len(self.seats), 2), np.uint8)
        start = {f"start.{name}": array.copy() for name, array in self._start.items()}
        return {**start, "seats": self.seats.copy(), "seeds": self._seeds.copy(), "played": played}

    def replay(self, arrays: Arrays, kitchens: Kitchens, partners: Partners) -> None:
        """Plays a saved episode again, up to where it was saved.

        Args:
            arrays: From `arrays`.
            kitchens: Brought to where they were then.
            partners: Those who played then; they are reset, and asked at every step.

        Raises:
            ValueError: The partners answer otherwise than they did, or the arrays are those of other kitchens.
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
                    f"{recorded[i]} when the snapshot was made; set the same partners, whose play depends on what "
                    "reset() told them and on what they see alone"
                )
            kitchens.play(joint, rewards, truncated)
            self.note(joint)


def generator_state(generator: np.random.Generator) -> NDArray[np.uint64]:
    """Gives all that a generator's future depends on: (6,) uint64."""
    state: Any = generator.bit_generator.state
    words = [word for name in ("state", "inc") for word in divmod(state["state"][name], _WORD + 1)]
    return np.array([*words, state["has_uint32"], state["uinteger"]], np.uint64)


def set_generator_state(generator: np.random.Generator, state: NDArray[Any]) -> None:
    """Takes back what `generator_state` gave."""
    high, low, inc_high, inc_low, has_uint32, uinteger = map(int, state.astype(np.uint64))
    generator.bit_generator.state = {
        "bit_generator": "PCG64",
        "state": {"state": high << 64 | low, "inc": inc_high << 64 | inc_low},
        "has_uint32": has_uint32,
        "uinteger": uinteger,
    }
