"""The rules of the game: what an interaction does, how chefs move, how pots cook, and which rewards are paid.

`interact` is plain Python, run once to fill a table; `step_kitchens` is the compiled step that reads it.

Source: overcooked_ai 1.1.0 and 2.0.0 (`OvercookedGridworld.get_state_transition`).
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen import codes
from overcooked_bench.kitchen.batch import CELLS, FACING, HELD, POSITION
from overcooked_bench.kitchen.codes import (
    BLOCKED,
    COUNTER,
    DISH,
    DISH_DISPENSER,
    DONE_BITS,
    INTERACT,
    MAX_INGREDIENTS,
    NOTHING,
    ONION,
    ONION_DISPENSER,
    PICKED_UP,
    PLATED,
    POT_COOKING,
    POT_IDLE,
    POT_READY,
    POTTED,
    PUT_DOWN,
    RECIPES,
    SERVED,
    SERVING,
    SOUP,
    STARTED,
    STAY,
    TOMATO,
    TOMATO_DISPENSER,
    TOOK,
    TOOK_DISH,
)
from overcooked_bench.kitchen.events import record_interaction
from overcooked_bench.kitchen.image import (
    URGENT_STEPS,
    paint_cell,
    paint_hand,
    paint_urgency,
)
from overcooked_bench.kitchen.jit import jit

COOKING_MODES: Final = ("auto", "manual")

POTTING_REWARD: Final = 3.0
USEFUL_DISH_REWARD: Final = 3.0
PLATING_REWARD: Final = 5.0

FIRST_OF_THREE: Final = next(k for k, recipe in enumerate(RECIPES) if sum(recipe) == MAX_INGREDIENTS)

ITEM_BITS, CELL_BITS = 4, 6
_ITEM_MASK, _CELL_MASK = (1 << ITEM_BITS) - 1, (1 << CELL_BITS) - 1


# Columns of `Tables.ways`: the cell ahead by facing, the wanted cell by action.
AHEAD: Final = 0
WANTED: Final = 4
# Columns of `Tables.by_code`: channels 16 to 24 of the image, then whether a pot starts by itself and its cook time.
PAINT: Final = 0
STARTS_ITSELF: Final = 9
COOK_TIME: Final = 10


def interact(cell: int, held: int, cooking: str) -> tuple[int, int, int]:
    """Returns the outcome of an interaction with a faced cell; combinations that are not listed do nothing.

    Args:
        cell: Code of the faced cell, tile and content together.
        held: Code of the item in the chef's hands.
        cooking: "auto" or "manual".

    Returns:
        The faced cell's new code, the new item in the hands, and the action taken as bits (`POTTED` and so on).

    Source: overcooked_ai (`OvercookedGridworld.resolve_interacts`).
    """
    empty_handed = held == NOTHING
    if COUNTER <= cell < ONION_DISPENSER:
        on_counter = cell - COUNTER
        if empty_handed != (on_counter == NOTHING):
            return COUNTER + held, on_counter, PICKED_UP if empty_handed else PUT_DOWN
    elif cell in (ONION_DISPENSER, TOMATO_DISPENSER, DISH_DISPENSER) and empty_handed:
        item = {ONION_DISPENSER: ONION, TOMATO_DISPENSER: TOMATO, DISH_DISPENSER: DISH}[cell]
        return cell, item, TOOK | TOOK_DISH if item == DISH else TOOK
    elif cell == SERVING and held > SOUP:
        return cell, NOTHING, SERVED
    elif codes.is_pot(cell):
        onions, tomatoes = RECIPES[codes.pot_recipe(cell)]
        idle, ready = cell <= POT_COOKING, cell > POT_READY
        if idle and held in (ONION, TOMATO) and onions + tomatoes < MAX_INGREDIENTS:
            grown = (onions + (held == ONION), tomatoes + (held == TOMATO))
            return POT_IDLE + RECIPES.index(grown), NOTHING, POTTED
        if idle and empty_handed and onions + tomatoes and cooking == "manual":
            return POT_COOKING + codes.pot_recipe(cell), NOTHING, STARTED
        if ready and held == DISH:
            return POT_IDLE, SOUP + codes.pot_recipe(cell), PLATED
    return cell, held, 0


@jit
def count_pots(row: NDArray[np.uint16], pots: NDArray[np.uint16], changed: int, code_before: int) -> tuple[int, int]:
    """Counts pots as they were at the start of the step.

    Args:
        row: The kitchen as it is now.
        pots: (P,) uint16.
        changed: Cell that the other chef has just changed in this step, -1 for none.
        code_before: Its code before.

    Returns:
        Pots that were full (cooking, ready or idle with three ingredients), and pots that a dish is useful for
        (cooking, ready or idle with one or two ingredients).
    """
    full, wanting = 0, 0
    for p in range(pots.shape[0]):
        code = code_before if pots[p] == changed else row[CELLS + pots[p]]
        if code > POT_COOKING:
            full += 1
            wanting += 1
        elif code >= POT_IDLE + FIRST_OF_THREE:
            full += 1
        elif code > POT_IDLE:
            wanting += 1
    return full, wanting


@jit
def dish_is_useful(row: NDArray[np.uint16], num_cells: int, wanting: int) -> bool:
    """Returns whether taking a dish is rewarded: none on a counter, fewer in hands than pots that want one.

    Source: overcooked_ai (`is_dish_pickup_useful`); counters and hands are read live, pots at the start of the step.
    """
    if int(row[HELD] == DISH) + int(row[HELD + 1] == DISH) >= wanting:
        return False
    for cell in range(num_cells):  # noqa: SIM110 (a generator does not compile)
        if row[CELLS + cell] == COUNTER + DISH:
            return False
    return True


@jit
def _step(  # noqa: C901 (the whole step in one place, and one compiled function)
    rows: NDArray[np.uint16],
    clock: NDArray[np.int64],
    image: NDArray[np.uint8],
    ways: NDArray[np.uint16],
    outcomes: NDArray[np.uint32],
    by_code: NDArray[np.uint8],
    payments: NDArray[np.float64],
    pots: NDArray[np.uint16],
    horizon: int,
    actions: NDArray[np.int64],
    rewards: NDArray[np.float64],
    truncated: NDArray[np.bool_],
    events: NDArray[np.bool_] | None,
    taken: NDArray[np.uint16] | None,
) -> tuple[int, int]:
    """Implements `step_and_note`; arrays that are None are not written, and compile to nothing."""
    for i in range(rows.shape[0]):
        a, b = actions[i, 0], actions[i, 1]
        if clock[i] >= horizon or a < 0 or a > INTERACT or b < 0 or b > INTERACT:
            return i, 0
    num_cells, num_pots, over = ways.shape[0], pots.shape[0], 0
    for i in range(rows.shape[0]):
        row, picture = rows[i], image[i]
        changed, code_before = -1, 0
        for chef in range(2):
            rewards[0, i, chef] = 0.0
            rewards[1, i, chef] = 0.0
            if taken is not None:
                taken[i, chef] = 0
            ahead = ways[row[POSITION + chef], AHEAD + row[FACING + chef]]
            code, item = row[CELLS + ahead], row[HELD + chef]
            outcome = outcomes[code, item]
            # One rare branch for "interacts, and something happens": a wrong guess costs more than the work.
            if not ((actions[i, chef] == INTERACT) & (outcome != code | item << CELL_BITS)):
                continue
            new_code, new_item = outcome & _CELL_MASK, (outcome >> CELL_BITS) & _ITEM_MASK
            done = outcome >> (CELL_BITS + ITEM_BITS)
            if events is not None:
                full, wanting = count_pots(row, pots, changed, code_before)
                useful = new_item == DISH and dish_is_useful(row, num_cells, wanting)
                record_interaction(
                    *(events[i, chef], code, new_code, item, new_item, full == num_pots, full == 0),
                    *(row[HELD + 1 - chef], useful, payments[1]),
                )
            if taken is not None:
                taken[i, chef] = done | (item if new_item == NOTHING else new_item) << DONE_BITS
            if done & POTTED:
                rewards[1, i, chef] = POTTING_REWARD
            elif done & PLATED:
                rewards[1, i, chef] = PLATING_REWARD
            elif done & SERVED:
                rewards[0, i, chef] = payments[0, item]
            elif done & TOOK_DISH:
                full, wanting = count_pots(row, pots, changed, code_before)
                if dish_is_useful(row, num_cells, wanting):
                    rewards[1, i, chef] = USEFUL_DISH_REWARD
            elif done & STARTED:
                for p in range(num_pots):
                    if pots[p] == ahead:
                        row[CELLS + num_cells + p] = by_code[code, COOK_TIME]
            row[HELD + chef] = new_item
            if new_code != code:
                row[CELLS + ahead] = new_code
                paint_cell(picture, num_cells, ahead, new_code, 0, by_code)
                if chef == 0:
                    changed, code_before = ahead, code
        if taken is not None:
            note_blocked(row, ways, actions[i, 0], actions[i, 1], taken[i])
        _move(row, picture, num_cells, ways, by_code, actions[i, 0], actions[i, 1])
        for p in range(num_pots):
            code = row[CELLS + pots[p]]
            if by_code[code, STARTS_ITSELF]:
                row[CELLS + num_cells + p] = by_code[code, COOK_TIME]
                code += POT_COOKING - POT_IDLE
                row[CELLS + pots[p]] = code
            if POT_COOKING < code <= POT_READY:
                left = row[CELLS + num_cells + p] - 1
                row[CELLS + num_cells + p] = left
                if left == 0:
                    code += POT_READY - POT_COOKING
                    row[CELLS + pots[p]] = code
                paint_cell(picture, num_cells, pots[p], code, left, by_code)
        clock[i] += 1
        steps_left = horizon - clock[i]
        truncated[i] = steps_left <= 0
        if steps_left <= 0:
            over += 1
        if steps_left == URGENT_STEPS - 1:
            paint_urgency(picture, num_cells)
    return -1, over


@jit
def note_blocked(
    row: NDArray[np.uint16], ways: NDArray[np.uint16], action_0: int, action_1: int, taken: NDArray[np.uint16]
) -> None:
    """Records in `taken`, (2,) uint16, which chefs the other one is about to keep from walking."""
    old_0, old_1 = row[POSITION], row[POSITION + 1]
    new_0, new_1 = ways[old_0, WANTED + action_0], ways[old_1, WANTED + action_1]
    if new_0 == new_1 or (new_0 == old_1 and new_1 == old_0):
        if new_0 != old_0:
            taken[0] = BLOCKED
        if new_1 != old_1:
            taken[1] = BLOCKED


@jit
def _move(
    row: NDArray[np.uint16],
    picture: NDArray[np.uint8],
    num_cells: int,
    ways: NDArray[np.uint16],
    by_code: NDArray[np.uint8],
    action_0: int,
    action_1: int,
) -> None:
    """Moves both chefs at once; after a collision or a swap both stay where they are, but they still turn."""
    old_0, old_1 = row[POSITION], row[POSITION + 1]
    new_0, new_1 = ways[old_0, WANTED + action_0], ways[old_1, WANTED + action_1]
    # Choices between two values, not branches: the processor cannot predict what chefs do.
    blocked = (new_0 == new_1) | ((new_0 == old_1) & (new_1 == old_0))
    row[POSITION] = old_0 if blocked else new_0
    row[POSITION + 1] = old_1 if blocked else new_1
    row[FACING] = action_0 if action_0 < STAY else row[FACING]
    row[FACING + 1] = action_1 if action_1 < STAY else row[FACING + 1]
    paint_hand(picture, num_cells, old_0, NOTHING, by_code)
    paint_hand(picture, num_cells, old_1, NOTHING, by_code)
    paint_hand(picture, num_cells, row[POSITION], row[HELD], by_code)
    paint_hand(picture, num_cells, row[POSITION + 1], row[HELD + 1], by_code)


@jit
def step_kitchens(
    rows: NDArray[np.uint16],
    clock: NDArray[np.int64],
    image: NDArray[np.uint8],
    ways: NDArray[np.uint16],
    outcomes: NDArray[np.uint32],
    by_code: NDArray[np.uint8],
    payments: NDArray[np.float64],
    pots: NDArray[np.uint16],
    horizon: int,
    actions: NDArray[np.int64],
    rewards: NDArray[np.float64],
    truncated: NDArray[np.bool_],
) -> tuple[int, int]:
    """Plays one joint action in each of N kitchens: chef 0 interacts, then chef 1, both move, then the pots cook.

    Args:
        rows: (N, 6 + C + P) uint16, the batch, changed in place, with `clock` and `image`; see `Batch`.
        clock: (N,) int64.
        image: (N, 26 * C) uint8.
        ways: (C, 10) uint16, the layout's tables, see `Tables`, with the four that follow.
        outcomes: (64, 16) uint32.
        by_code: (64, 11) uint8.
        payments: (2, 16) float64.
        pots: (P,) uint16.
        horizon: Steps per episode.
        actions: (N, 2) int64.
        rewards: (2, N, 2) float64, written: [0] points of each chef's delivery, [1] each chef's partial rewards.
        truncated: (N,) bool, written.

    Returns:
        The first kitchen that cannot be stepped, or -1, and how many kitchens are over now. If one cannot be
        stepped (a wrong action, or it is over), nothing was changed.
    """
    return _step(
        *(rows, clock, image, ways, outcomes, by_code, payments, pots),
        *(horizon, actions, rewards, truncated, None, None),
    )


@jit
def step_and_note(
    rows: NDArray[np.uint16],
    clock: NDArray[np.int64],
    image: NDArray[np.uint8],
    ways: NDArray[np.uint16],
    outcomes: NDArray[np.uint32],
    by_code: NDArray[np.uint8],
    payments: NDArray[np.float64],
    pots: NDArray[np.uint16],
    horizon: int,
    actions: NDArray[np.int64],
    rewards: NDArray[np.float64],
    truncated: NDArray[np.bool_],
    events: NDArray[np.bool_] | None,
    taken: NDArray[np.uint16] | None,
) -> tuple[int, int]:
    """Steps like `step_kitchens`, whose arguments come first, and records events and actions taken.

    Args:
        rows: See `step_kitchens`, like the eleven that follow.
        clock: See there.
        image: See there.
        ways: See there.
        outcomes: See there.
        by_code: See there.
        payments: See there.
        pots: See there.
        horizon: See there.
        actions: See there.
        rewards: See there.
        truncated: See there.
        events: (N, 2, 25) bool of zeros, written in the order of `EVENTS`; None if they are not wanted.
        taken: (N, 2) uint16, written, see `StepResult.actions_taken`; None if not wanted.

    Returns:
        See `step_kitchens`.
    """
    return _step(
        *(rows, clock, image, ways, outcomes, by_code, payments, pots),
        *(horizon, actions, rewards, truncated, events, taken),
    )
