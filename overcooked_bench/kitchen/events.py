"""The 25 events of the reference kitchen, each with the chef who caused it.

Source: overcooked_ai (`EVENT_TYPES` and the `log_object_*` methods of `OvercookedGridworld`).
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.codes import (
    COUNTER,
    DISH,
    NOTHING,
    ONION,
    ONION_DISPENSER,
    POT_IDLE,
    RECIPES,
    SOUP,
    TOMATO,
    TOMATO_DISPENSER,
)
from overcooked_bench.kitchen.jit import jit

EVENTS: Final = (
    *("tomato_pickup", "useful_tomato_pickup", "tomato_drop", "useful_tomato_drop", "potting_tomato"),
    *("onion_pickup", "useful_onion_pickup", "onion_drop", "useful_onion_drop", "potting_onion"),
    *("dish_pickup", "useful_dish_pickup", "dish_drop", "useful_dish_drop"),
    *("soup_pickup", "soup_delivery", "soup_drop"),
    *("optimal_onion_potting", "optimal_tomato_potting", "viable_onion_potting", "viable_tomato_potting"),
    *("catastrophic_onion_potting", "catastrophic_tomato_potting", "useless_onion_potting", "useless_tomato_potting"),
)
"""Names in the order of the last axis of `StepResult.events`."""

# The first event of each item's group; + 1 useful pickup, + 2 drop, + 3 useful drop, + 4 potting.
_TOMATO, _ONION, _DISH = 0, 5, 10
_SOUP_PICKUP, _SOUP_DELIVERY, _SOUP_DROP = 14, 15, 16
_OPTIMAL, _VIABLE, _CATASTROPHIC, _USELESS = 17, 19, 21, 23  # onion; + 1 tomato


def best_reachable(soup_rewards: NDArray[np.float64]) -> NDArray[np.float64]:
    """Returns v(r), the best payment reachable from each content of a pot by adding ingredients.

    Args:
        soup_rewards: (10,) float64, points by recipe index.

    Returns:
        (10,) float64 by recipe index, the empty pot included.
    """
    return np.array(
        [
            max(soup_rewards[k] for k, (o, t) in enumerate(RECIPES) if o >= onions and t >= tomatoes)
            for onions, tomatoes in RECIPES
        ]
    )


@jit
def record_interaction(  # noqa: C901 (a list of cases; splitting it would hide it)
    flags: NDArray[np.bool_],
    cell: int,
    new_cell: int,
    held: int,
    held_after: int,
    all_full: bool,
    none_full: bool,
    other_held: int,
    useful_dish: bool,
    potential: NDArray[np.float64],
) -> None:
    """Records one interaction's events, as the reference kitchen logs them.

    Args:
        flags: (25,) bool, written.
        cell: Code of the faced cell before the interaction.
        new_cell: Its code after.
        held: Code of the item in the hands before.
        held_after: Code of the item in the hands after.
        all_full: Whether every pot was cooking, ready or idle with three ingredients when the step began.
        none_full: Whether no pot was.
        other_held: The item in the other chef's hands at this point of the step.
        useful_dish: Whether a dish taken now counts as useful.
        potential: float64 by recipe index, `best_reachable`.
    """
    wanted = not (all_full and other_held != DISH)
    if cell >= POT_IDLE and held in (ONION, TOMATO) and held_after == NOTHING:
        tomato = held == TOMATO
        flags[(_TOMATO if tomato else _ONION) + 4] = True
        before, after = cell - POT_IDLE, new_cell - POT_IDLE
        shift = 1 if tomato else 0
        flags[_OPTIMAL + shift] = potential[before] == potential[after]
        flags[_VIABLE + shift] = potential[after] > 0
        flags[_CATASTROPHIC + shift] = potential[before] > 0 and potential[after] == 0
        flags[_USELESS + shift] = potential[before] == 0
    elif held == NOTHING and held_after != NOTHING:
        if held_after == ONION:
            flags[_ONION] = True
            flags[_ONION + 1] = wanted
        elif held_after == TOMATO and cell != TOMATO_DISPENSER:  # the reference logs no tomato from a dispenser
            flags[_TOMATO] = True
            flags[_TOMATO + 1] = wanted
        elif held_after == DISH:
            flags[_DISH] = True
            flags[_DISH + 1] = useful_dish
        elif held_after > SOUP:
            flags[_SOUP_PICKUP] = True
    elif held == DISH and held_after > SOUP:
        flags[_SOUP_PICKUP] = True
    elif held != NOTHING and held_after == NOTHING:
        if not COUNTER <= cell < ONION_DISPENSER:
            flags[_SOUP_DELIVERY] = True
        elif held == ONION:
            flags[_ONION + 2] = True
            flags[_ONION + 3] = not wanted
        elif held == TOMATO:
            flags[_TOMATO + 2] = True
            flags[_TOMATO + 3] = not wanted
        elif held == DISH:
            flags[_DISH + 2] = True
            flags[_DISH + 3] = none_full and other_held != ONION
        else:
            flags[_SOUP_DROP] = True
