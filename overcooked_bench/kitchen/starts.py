"""Start states: standard or random, with one counter-based random stream per kitchen.

Source: the thesis, 4.3.4 and 6.2.1 (random starts, one chef in each region); overcooked_ai
(`get_random_start_state_fn`) for the share of pots and hands that are filled.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import CELLS, HELD, POSITION
from overcooked_bench.kitchen.codes import DISH, ONION, POT_COOKING, POT_IDLE, POT_READY, RECIPES, SOUP, TOMATO
from overcooked_bench.kitchen.image import paint_kitchen
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.rules import COOK_TIME, FIRST_OF_THREE

STARTS: Final = ("random", "standard")

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1, _MIX_2 = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_30, _27, _31, _32 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(32)
_RECIPES = np.array(RECIPES, np.int64)
_PERCENT_DISH, _PERCENT_INGREDIENT = 20, 60  # content of a filled hand; soups for the rest


def stream_keys(seed: int | NDArray[np.uint64] | None, num_kitchens: int) -> NDArray[np.uint64]:
    """Returns every kitchen the key of its random stream, (N,) uint64.

    Args:
        seed: A whole number, of which kitchen i's key depends on (seed, i) alone; or (N,) keys; or None for entropy.
        num_kitchens: N.

    Raises:
        ValueError: A negative seed, or keys of another shape.
    """
    if isinstance(seed, np.ndarray):
        if seed.shape != (num_kitchens,):
            raise ValueError(f"seed has the shape {seed.shape}; give one number or an array of shape ({num_kitchens},)")
        if seed.dtype.kind not in "iu" or (seed.dtype.kind == "i" and (seed < 0).any()):
            raise ValueError(f"seed holds {seed.dtype} keys; give whole numbers from 0, such as a uint64 array")
        return seed.astype(np.uint64)
    if seed is not None and (isinstance(seed, bool) or not isinstance(seed, int | np.integer) or seed < 0):
        raise ValueError(f"seed={seed!r}; give a whole number from 0, or an array of one key per kitchen")
    base = np.random.SeedSequence(seed).generate_state(1, np.uint64)
    keys: NDArray[np.uint64] = _mixed(base + np.arange(1, num_kitchens + 1, dtype=np.uint64) * _GOLDEN)
    return keys


def _mixed(z: Any) -> Any:
    """Mixes the 64 bits of a number or of each number in an array (Steele, Lea and Flood 2014, SplitMix64)."""
    z = (z ^ (z >> _30)) * _MIX_1
    z = (z ^ (z >> _27)) * _MIX_2
    return z ^ (z >> _31)


_mixed_one = jit(_mixed)


@jit
def draw(stream: NDArray[np.uint64], below: int) -> np.int64:
    """Draws a whole number from 0 to below - 1 and advances the stream, (2,) uint64 key and count."""
    stream[1] += np.uint64(1)
    bits = _mixed_one(stream[0] + stream[1] * _GOLDEN)
    return np.int64(((bits >> _32) * np.uint64(below)) >> _32)


@jit
def start_kitchens(
    rows: NDArray[np.uint16],
    clock: NDArray[np.int64],
    image: NDArray[np.uint8],
    stream: NDArray[np.uint64],
    mask: NDArray[np.bool_],
    fresh: NDArray[np.uint16],
    floor: NDArray[np.uint16],
    allowed: NDArray[np.bool_],
    standard: NDArray[np.uint16],
    pots: NDArray[np.uint16],
    by_code: NDArray[np.uint8],
    background: NDArray[np.uint8],
    horizon: int,
    random: bool,
) -> None:
    """Puts the kitchens of a mask into start states, with empty pots and hands; chefs look north.

    Args:
        rows: (N, 6 + C + P) uint16, changed in place, like `clock`, `image` and `stream`; see `Batch`.
        clock: (N,) int64.
        image: (N, 26 * C) uint8.
        stream: (N, 2) uint64.
        mask: (N,) bool.
        fresh: (C,) uint16, a table of the layout like the six that follow; see `Tables`.
        floor: (F, 2) uint16.
        allowed: (R, R) bool.
        standard: (2,) uint16.
        pots: (P,) uint16.
        by_code: (64, 11) uint8.
        background: (26 * C,) uint8.
        horizon: Steps of an episode, for the urgency plane.
        random: Whether start cells are random: uniform over the ordered pairs of distinct floor cells whose regions
            `Layout.start_regions` allows.
    """
    num_floor = floor.shape[0]
    for i in range(mask.shape[0]):
        if not mask[i]:
            continue
        row = rows[i]
        for k in range(row.shape[0]):
            row[k] = 0  # which is facing north, empty-handed, nothing cooking
        for cell in range(fresh.shape[0]):
            row[CELLS + cell] = fresh[cell]
        clock[i] = 0
        if random:
            a, b = np.int64(0), np.int64(0)
            while a == b or not allowed[floor[a, 1], floor[b, 1]]:
                a, b = draw(stream[i], num_floor), draw(stream[i], num_floor)
            row[POSITION], row[POSITION + 1] = floor[a, 0], floor[b, 0]
        else:
            row[POSITION], row[POSITION + 1] = standard[0], standard[1]
        paint_kitchen(image[i], row, horizon, background, by_code, pots)


@jit
def fill_kitchens(
    rows: NDArray[np.uint16],
    image: NDArray[np.uint8],
    stream: NDArray[np.uint64],
    mask: NDArray[np.bool_],
    orders: NDArray[np.uint16],
    pots: NDArray[np.uint16],
    by_code: NDArray[np.uint8],
    background: NDArray[np.uint8],
    horizon: int,
    object_probability: float,
) -> None:
    """Fills pots and hands of freshly started kitchens; arguments as for `start_kitchens`.

    It is a separate kernel since most kitchens start empty, and need not wait for it to be compiled.

    Args:
        rows: (N, 6 + C + P) uint16, changed in place, like `image` and `stream`; see `Batch`.
        image: (N, 26 * C) uint8.
        stream: (N, 2) uint64.
        mask: (N,) bool.
        orders: (K, 3) uint16, a table of the layout like the three that follow; see `Tables`.
        pots: (P,) uint16.
        by_code: (64, 11) uint8.
        background: (26 * C,) uint8.
        horizon: Steps of an episode.
        object_probability: Chance of each pot and each pair of hands to be filled from the orders.
    """
    threshold, num_cells = int(object_probability * 2**31), rows.shape[1] - CELLS - pots.shape[0]
    for i in range(mask.shape[0]):
        if mask[i]:
            _fill(rows[i], stream[i], threshold, num_cells, orders, pots, by_code)
            paint_kitchen(image[i], rows[i], horizon, background, by_code, pots)


@jit
def _fill(
    row: NDArray[np.uint16],
    stream: NDArray[np.uint64],
    threshold: int,
    num_cells: int,
    orders: NDArray[np.uint16],
    pots: NDArray[np.uint16],
    by_code: NDArray[np.uint8],
) -> None:
    """Fills pots and hands with ingredients of the orders.

    A pot gets between one ingredient and a whole random order; a whole order is anywhere between just started and
    ready.
    """
    for p in range(pots.shape[0]):
        if draw(stream, 2**31) >= threshold:
            continue
        order = draw(stream, orders.shape[0])
        recipe, total = orders[order, 0], orders[order, 1] + orders[order, 2]
        taken = 1 + draw(stream, total)
        if taken == total:
            left = draw(stream, by_code[POT_IDLE + recipe, COOK_TIME] + 1)
            row[CELLS + pots[p]] = (POT_COOKING if left > 0 else POT_READY) + recipe
            row[CELLS + num_cells + p] = left
            continue
        onions = 0
        for k in range(taken):
            if draw(stream, total - k) < orders[order, 1] - onions:
                onions += 1
        for k in range(FIRST_OF_THREE):
            if _RECIPES[k, 0] == onions and _RECIPES[k, 1] == taken - onions:
                row[CELLS + pots[p]] = POT_IDLE + k
    for chef in range(2):
        if draw(stream, 2**31) >= threshold:
            continue
        order, kind = draw(stream, orders.shape[0]), draw(stream, 100)
        if kind < _PERCENT_DISH:
            row[HELD + chef] = DISH
        elif kind < _PERCENT_DISH + _PERCENT_INGREDIENT:
            row[HELD + chef] = ONION if draw(stream, orders[order, 1] + orders[order, 2]) < orders[order, 1] else TOMATO
        else:
            row[HELD + chef] = SOUP + orders[order, 0]
