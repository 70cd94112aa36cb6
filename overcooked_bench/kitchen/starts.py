"""Start states: standard or random, with counter-based random streams so that a kitchen's fate is its own.

Source: the thesis, 4.3.4 and 6.2.1 (random starts, one chef in each region); overcooked_ai
(`get_random_start_state_fn`) for the share of pots and hands that are filled. Kitchen-spec section 6.
"""

from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import DISH, NORTH, NOTHING, ONION, POT_COOKING, POT_IDLE, POT_READY, RECIPES, SOUP, TOMATO
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.observations import paint_kitchen
from overcooked_bench.kitchen.rules import FIRST_OF_THREE, Plan
from overcooked_bench.kitchen.state import Batch

STARTS: Final = ("random", "standard")

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1, _MIX_2 = np.uint64(0xBF58476D1CE4E5B9), np.uint64(0x94D049BB133111EB)
_30, _27, _31, _32 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(32)
_RECIPES = np.array(RECIPES, np.int64)
_PERCENT_DISH, _PERCENT_INGREDIENT = 20, 60  # what a filled hand holds; soups for the rest


def stream_keys(seed: int | NDArray[np.uint64] | None, num_kitchens: int) -> NDArray[np.uint64]:
    """Gives every kitchen the key of its random stream, (N,) uint64.

    Args:
        seed: A whole number, of which kitchen i's key depends on (seed, i) alone; or (N,) keys; or None for entropy.
        num_kitchens: N.

    Raises:
        ValueError: A negative seed, or keys of another shape.
    """
    if isinstance(seed, np.ndarray):
        if seed.shape != (num_kitchens,):
            raise ValueError(f"seed has the shape {seed.shape}; give one number or an array of shape ({num_kitchens},)")
        return seed.astype(np.uint64)
    base = np.random.SeedSequence(seed).generate_state(1, np.uint64)
    return _mixed(base + np.arange(1, num_kitchens + 1, dtype=np.uint64) * _GOLDEN)


def _mixed(z: Any) -> Any:
    """Scrambles 64 bits, of one number or of each in an array (Steele, Lea and Flood 2014, SplitMix64)."""
    z = (z ^ (z >> _30)) * _MIX_1
    z = (z ^ (z >> _27)) * _MIX_2
    return z ^ (z >> _31)


_mixed_one = jit(_mixed)


@jit
def draw(stream: NDArray[np.uint64], below: int) -> int:
    """Draws a whole number from 0 to below - 1 and advances the stream, (2,) uint64 key and count."""
    stream[1] += np.uint64(1)
    bits = _mixed_one(stream[0] + stream[1] * _GOLDEN)
    return np.int64(((bits >> _32) * np.uint64(below)) >> _32)


@jit
def start_kitchen(batch: Batch, plan: Plan, i: int, random: bool, object_probability: float, horizon: int) -> None:
    """Puts kitchen i into a start state; chefs look north.

    Args:
        batch: N kitchens, changed in place.
        plan: Their layout's tables.
        i: Which kitchen.
        random: Whether the start cells are drawn: uniform over the ordered pairs of distinct floor cells whose regions
            `Layout.start_regions` allows.
        object_probability: Chance of each pot and each pair of hands to be filled from the orders.
        horizon: Steps of an episode, for the urgency plane.
    """
    cells, position, held, stream = batch.cells[i], batch.position[i], batch.held[i], batch.stream[i]
    for cell in range(cells.shape[0]):  # a slice assignment would take seconds to compile
        cells[cell] = plan.fresh_cells[cell]
    for p in range(plan.pots.shape[0]):
        batch.remaining[i, p] = 0
    for chef in range(2):
        batch.facing[i, chef] = NORTH
        held[chef] = NOTHING
    batch.timestep[i] = 0
    if random:
        a, b = 0, 0
        while a == b or not plan.allowed[plan.region[a], plan.region[b]]:
            a, b = draw(stream, plan.floor.shape[0]), draw(stream, plan.floor.shape[0])
        position[0], position[1] = plan.floor[a], plan.floor[b]
    else:
        position[0], position[1] = plan.standard[0], plan.standard[1]
    if object_probability > 0:
        _fill(batch, plan, i, object_probability)
    paint_kitchen(
        *(batch.image[i], cells, batch.remaining[i], position, held, horizon),
        *(plan.background, plan.pot_at, plan.paint),
    )


@jit
def _fill(batch: Batch, plan: Plan, i: int, probability: float) -> None:
    """Fills pots and hands with what the orders use.

    A pot gets one ingredient up to a whole random order; a whole one is anywhere between just started and ready.
    """
    cells, held, stream = batch.cells[i], batch.held[i], batch.stream[i]
    threshold = int(probability * 2**31)
    for p in range(plan.pots.shape[0]):
        if draw(stream, 2**31) >= threshold:
            continue
        recipe = plan.order_ids[draw(stream, plan.order_ids.shape[0])]
        total = _RECIPES[recipe, 0] + _RECIPES[recipe, 1]
        taken = 1 + draw(stream, total)
        if taken == total:
            left = draw(stream, plan.cook_times[recipe] + 1)
            cells[plan.pots[p]] = (POT_COOKING if left else POT_READY) + recipe
            batch.remaining[i, p] = left
        else:
            onions, tomatoes, left = 0, 0, _RECIPES[recipe, 0]
            for k in range(taken):
                if draw(stream, total - k) < left - onions:
                    onions += 1
                else:
                    tomatoes += 1
            for k in range(FIRST_OF_THREE):
                if _RECIPES[k, 0] == onions and _RECIPES[k, 1] == tomatoes:
                    cells[plan.pots[p]] = POT_IDLE + k
    for chef in range(2):
        if draw(stream, 2**31) >= threshold:
            continue
        recipe = plan.order_ids[draw(stream, plan.order_ids.shape[0])]
        kind = draw(stream, 100)
        if kind < _PERCENT_DISH:
            held[chef] = DISH
        elif kind < _PERCENT_DISH + _PERCENT_INGREDIENT:
            total = _RECIPES[recipe, 0] + _RECIPES[recipe, 1]
            held[chef] = ONION if draw(stream, total) < _RECIPES[recipe, 0] else TOMATO
        else:
            held[chef] = SOUP + recipe
