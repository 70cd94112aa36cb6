"""Random draws per row: they depend on the row's seed and the step alone, never on the batch.

Axes: B rows.
"""

from typing import Final

import numpy as np
from numpy.typing import ArrayLike, NDArray

from overcooked_bench.kitchen.codes import NUM_ACTIONS

_GOLDEN, _MIX_1, _MIX_2 = 0x9E3779B97F4A7C15, 0xBF58476D1CE4E5B9, 0x94D049BB133111EB
_WORD: Final = 2**64 - 1
_ROUNDING: Final = 1e-3  # rounding error of a softmax in float16
_MOST_STEPS_AHEAD: Final = 64
_MOST_DRAWS_AHEAD: Final = 2**16


def uniforms(seeds: NDArray[np.uint64], step: int) -> NDArray[np.float64]:
    """Draws one number in [0, 1) per row; it depends on the row's seed and the step alone.

    Args:
        seeds: (B,) uint64.
        step: Steps since the start, from 0; every step has an independent draw.

    Returns:
        (B,) float64.

    Source: Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators" (SplitMix64's finaliser).
    """
    return _uniforms(_keys(seeds), range(step, step + 1)).reshape(-1)


def sample_actions(probabilities: ArrayLike, seeds: NDArray[np.uint64], step: int) -> NDArray[np.int64]:
    """Draws one action per row; row i's draw depends on its probabilities, its seed and the step alone.

    Args:
        probabilities: (B, 6); each row sums to 1 up to rounding. An action of probability 0 is never drawn.
        seeds: (B,) uint64.
        step: Steps since the start, from 0.

    Returns:
        (B,) int64.

    Raises:
        ValueError: A wrong shape, a negative or undefined probability, or a row that does not sum to 1.
    """
    return _drawn(probabilities, uniforms(seeds, step))


class ActionSampler:
    """Draws the same actions as `sample_actions` for one set of seeds, step by step from step 0 on.

    It computes the random numbers of many steps at once, which takes a fraction of the time.

    Args:
        seeds: (B,) uint64.
    """

    def __init__(self, seeds: NDArray[np.uint64]) -> None:
        self._keys = _keys(seeds)
        self._ahead = np.empty((0, len(self._keys)))
        self._step = 0

    def draw(self, probabilities: ArrayLike) -> NDArray[np.int64]:
        """Draws the next step's actions; see `sample_actions`."""
        steps = max(1, min(_MOST_STEPS_AHEAD, _MOST_DRAWS_AHEAD // max(1, len(self._keys))))
        at = self._step % steps
        if at == 0:
            self._ahead = _uniforms(self._keys, range(self._step, self._step + steps))
        actions = _drawn(probabilities, self._ahead[at])
        self._step += 1
        return actions


def _drawn(probabilities: ArrayLike, draws: NDArray[np.float64]) -> NDArray[np.int64]:
    chances = np.asarray(probabilities, np.float64)
    if chances.shape != (len(draws), NUM_ACTIONS):
        raise ValueError(
            f"probabilities have the shape {chances.shape}; {len(draws)} seeds need ({len(draws)}, {NUM_ACTIONS})"
        )
    sums = chances.cumsum(1)
    if not (chances.min(initial=0) >= 0 and np.abs(sums[:, -1] - 1).max(initial=0) <= _ROUNDING):
        good = (chances >= 0).all(axis=1) & (np.abs(sums[:, -1] - 1) <= _ROUNDING)
        row = int(np.argmin(good))
        raise ValueError(f"row {row}: {chances[row].tolist()}; give six probabilities, from 0, that sum to 1")
    drawn = (sums <= draws[:, None]).sum(1, dtype=np.int64)
    if drawn.max(initial=0) == NUM_ACTIONS:  # rounding may end a row's sum below its draw
        drawn = np.minimum(drawn, NUM_ACTIONS - 1 - np.argmax(chances[:, ::-1] > 0, axis=1))
    actions: NDArray[np.int64] = drawn
    return actions


def _keys(seeds: NDArray[np.uint64]) -> NDArray[np.uint64]:
    return _mixed(np.asarray(seeds, np.uint64) + np.uint64(_GOLDEN))


def _uniforms(keys: NDArray[np.uint64], steps: range) -> NDArray[np.float64]:
    """Returns the draws of several steps: (steps, B)."""
    offsets = np.array([(step + 1) * _GOLDEN & _WORD for step in steps], np.uint64)
    bits = _mixed(keys + offsets[:, None])
    return (bits >> np.uint64(11)).astype(np.float64) * 2.0**-53


def _mixed(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    z = (z ^ (z >> np.uint64(30))) * np.uint64(_MIX_1)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(_MIX_2)
    return z ^ (z >> np.uint64(31))
