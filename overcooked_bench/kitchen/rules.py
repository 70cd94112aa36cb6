"""The rules of the game, written once: what an interaction does, who moves, how pots cook, what is paid.

`interact` and `POT_*` tables are plain Python run once a kitchen; `step_kitchen` is the compiled step that reads them.

Source: overcooked_ai 1.1.0 and 2.0.0 (`OvercookedGridworld.get_state_transition`), told in kitchen-spec sections 2 and 3.
"""

from typing import Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen import codes
from overcooked_bench.kitchen.codes import (
    COUNTER,
    DISH,
    DISH_DISPENSER,
    FLOOR,
    INTERACT,
    MAX_INGREDIENTS,
    NOTHING,
    NUM_CELL_CODES,
    NUM_ITEMS,
    ONION,
    ONION_DISPENSER,
    POT_COOKING,
    POT_IDLE,
    POT_READY,
    RECIPES,
    SERVING,
    SOUP,
    STAY,
    TOMATO,
    TOMATO_DISPENSER,
)
from overcooked_bench.kitchen.events import best_reachable, record_interaction
from overcooked_bench.kitchen.jit import jit
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations import background, paint_cell, paint_table
from overcooked_bench.kitchen.state import Batch

COOKING_MODES: Final = ("auto", "manual")

POTTING_REWARD: Final = 3.0
USEFUL_DISH_REWARD: Final = 3.0
PLATING_REWARD: Final = 5.0

# What an interaction did besides changing the faced cell and the hands.
POTTED, PLATED, SERVED, TOOK_DISH, STARTED = 1, 2, 4, 8, 16

FIRST_OF_THREE: Final = next(k for k, recipe in enumerate(RECIPES) if sum(recipe) == MAX_INGREDIENTS)

_ITEM_BITS, _CELL_BITS = 4, 6
_ITEM_MASK, _CELL_MASK = (1 << _ITEM_BITS) - 1, (1 << _CELL_BITS) - 1


class Plan(NamedTuple):
    """A layout and a cooking mode compiled to tables. C cells in row-major order, P pots, F floor cells.

    Attributes:
        front: (C, 4) int16  cell that a chef at this cell sees, by facing
        target: (C, 6) int16  cell that a chef at this cell wants with this action
        outcomes: (64, 16) uint16  by faced cell code and held item: new cell code, new held item and what was done
        soup_rewards: (16,) float64  points for serving this held item
        cook_times: (10,) uint8  steps by recipe index
        starts_itself: (64,) bool  pots that begin to cook at the end of a step without a hand
        pots: (P,) int16  cells
        pot_at: (C,) int16  which pot is at a cell, -1 elsewhere
        fresh_cells: (C,) uint8  cell codes of the empty kitchen
        floor: (F,) int16  cells
        region: (F,) int16  region of each floor cell
        allowed: (R, R) bool  whether a random start may put chef 0 in one region and chef 1 in the other
        standard: (2,) int16  standard start cells, -1 where the layout names none
        order_ids: (K,) uint8  recipe indices of the orders
        background: (26, C) uint8  lossless encoding of the empty kitchen without chefs
        paint: (64, 9) uint8  channels 16 to 24 of a cell by its code
        potential: (10,) float64  best payment reachable from each recipe index by adding ingredients
    """

    front: NDArray[np.int16]
    target: NDArray[np.int16]
    outcomes: NDArray[np.uint16]
    soup_rewards: NDArray[np.float64]
    cook_times: NDArray[np.uint8]
    starts_itself: NDArray[np.bool_]
    pots: NDArray[np.int16]
    pot_at: NDArray[np.int16]
    fresh_cells: NDArray[np.uint8]
    floor: NDArray[np.int16]
    region: NDArray[np.int16]
    allowed: NDArray[np.bool_]
    standard: NDArray[np.int16]
    order_ids: NDArray[np.uint8]
    background: NDArray[np.uint8]
    paint: NDArray[np.uint8]
    potential: NDArray[np.float64]


def interact(cell: int, held: int, cooking: str) -> tuple[int, int, int]:
    """Says what an interaction with a faced cell does; whatever is not listed does nothing.

    Args:
        cell: Code of the faced cell, tile and content together.
        held: Code of the item in the chef's hands.
        cooking: "auto" or "manual".

    Returns:
        The faced cell's new code, the new item in the hands, and flags of what was done.

    Source: kitchen-spec section 2b.
    """
    empty_handed = held == NOTHING
    if COUNTER <= cell < ONION_DISPENSER:
        on_counter = cell - COUNTER
        if empty_handed or on_counter == NOTHING:
            return COUNTER + held, on_counter, 0
    elif cell in (ONION_DISPENSER, TOMATO_DISPENSER, DISH_DISPENSER) and empty_handed:
        item = {ONION_DISPENSER: ONION, TOMATO_DISPENSER: TOMATO, DISH_DISPENSER: DISH}[cell]
        return cell, item, TOOK_DISH if item == DISH else 0
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


def compile_plan(layout: Layout, cooking: str) -> Plan:
    """Turns a layout and a cooking mode into the tables that the kernels read."""
    if cooking not in COOKING_MODES:
        raise ValueError(f"cooking={cooking!r}; choose one of {', '.join(map(repr, COOKING_MODES))}")
    short = [order for order in layout.orders if sum(order) != MAX_INGREDIENTS]
    if cooking == "auto" and short:
        raise ValueError(
            f"cooking='auto' starts a pot at its third ingredient, and orders with fewer, such as {short[0]} "
            "(onions, tomatoes), can never be cooked; use cooking='manual' or orders of three"
        )
    width, cells = layout.width, layout.width * layout.height
    fresh = np.array([codes.TILES[tile] for row in layout.rows for tile in row], np.uint8)
    front = np.zeros((cells, 4), np.int16)
    target = np.repeat(np.arange(cells, dtype=np.int16)[:, None], codes.NUM_ACTIONS, axis=1)
    for x, y in layout.positions(" "):
        for direction, (dx, dy) in enumerate(codes.DIRECTIONS):
            cell, ahead = y * width + x, (y + dy) * width + x + dx
            front[cell, direction] = ahead
            if fresh[ahead] == codes.FLOOR:
                target[cell, direction] = ahead
    outcomes = np.zeros((1 << _CELL_BITS, 1 << _ITEM_BITS), np.uint16)
    for cell in range(NUM_CELL_CODES):
        for held in range(NUM_ITEMS):
            new_cell, new_held, done = interact(cell, held, cooking)
            outcomes[cell, held] = new_cell | new_held << _CELL_BITS | done << (_CELL_BITS + _ITEM_BITS)
    starts_itself = np.zeros(1 << _CELL_BITS, np.bool_)
    if cooking == "auto":
        for index, recipe in enumerate(RECIPES):
            starts_itself[POT_IDLE + index] = sum(recipe) == MAX_INGREDIENTS
    rewards = np.zeros(1 << _ITEM_BITS)
    rewards[SOUP : SOUP + len(RECIPES)] = layout.soup_rewards
    pots = np.flatnonzero(fresh >= POT_IDLE).astype(np.int16)
    pot_at = np.full(cells, -1, np.int16)
    pot_at[pots] = np.arange(len(pots))
    floor = layout.positions(" ")
    regions = max(layout.regions.values()) + 1
    allowed = np.zeros((regions, regions), np.bool_)
    for a, b in layout.start_regions:
        allowed[a, b] = True
    return Plan(
        front=front,
        target=target,
        outcomes=outcomes,
        soup_rewards=rewards,
        cook_times=np.array(layout.cook_times, np.uint8),
        starts_itself=starts_itself,
        pots=pots,
        pot_at=pot_at,
        fresh_cells=fresh,
        floor=np.array([y * width + x for x, y in floor], np.int16),
        region=np.array([layout.regions[cell] for cell in floor], np.int16),
        allowed=allowed,
        standard=np.array([y * width + x for x, y in layout.start_cells] or [-1, -1], np.int16),
        order_ids=np.array([RECIPES.index(order) for order in layout.orders], np.uint8),
        background=background(layout),
        paint=paint_table(),
        potential=best_reachable(np.array(layout.soup_rewards)),
    )


@jit
def count_pots(
    cells: NDArray[np.uint8], pots: NDArray[np.int16], changed: int, code_before: int
) -> tuple[int, int]:
    """Counts the pots as they were when the step began.

    Args:
        cells: (C,) uint8, as they are now.
        pots: (P,) int16.
        changed: Cell that the other chef has just changed in this step, -1 for none.
        code_before: Its code before.

    Returns:
        Pots that were full (cooking, ready or idle with three ingredients), and pots that a dish is useful for (cooking,
        ready or idle with one or two ingredients).
    """
    full, wanting = 0, 0
    for p in range(pots.shape[0]):
        code = code_before if pots[p] == changed else cells[pots[p]]
        if code > POT_COOKING:
            full += 1
            wanting += 1
        elif code >= POT_IDLE + FIRST_OF_THREE:
            full += 1
        elif code > POT_IDLE:
            wanting += 1
    return full, wanting


@jit
def dish_is_useful(cells: NDArray[np.uint8], held: NDArray[np.uint8], wanting: int) -> bool:
    """Tells whether taking a dish is rewarded: none on a counter, fewer in hands than pots that want one.

    Source: overcooked_ai (`is_dish_pickup_useful`); counters and hands are read live, pots at the start of the step.
    """
    in_hands = int(held[0] == DISH) + int(held[1] == DISH)
    if in_hands >= wanting:
        return False
    for cell in range(cells.shape[0]):
        if cells[cell] == COUNTER + DISH:
            return False
    return True


@jit
def step_kitchen(
    batch: Batch,
    plan: Plan,
    i: int,
    actions: NDArray[np.int64],
    soup_reward: NDArray[np.float64],
    partial_reward: NDArray[np.float64],
    events: NDArray[np.bool_],
) -> None:
    """Plays one joint action in kitchen i: interactions of chef 0, then of chef 1, then both move, then the pots cook.

    Args:
        batch: N kitchens, changed in place.
        plan: Their layout's tables.
        i: Which kitchen.
        actions: (2,) ints from 0 to 5.
        soup_reward: (2,) float64, written: points of each chef's delivery.
        partial_reward: (2,) float64, written: each chef's partial rewards.
        events: (2, 25) bool, written; (0, 25) where they are not wanted.
    """
    cells, held, image = batch.cells[i], batch.held[i], batch.image[i]
    position, facing, remaining = batch.position[i], batch.facing[i], batch.remaining[i]
    before_0, before_1 = held[0], held[1]
    changed, code_before = -1, 0
    for chef in range(2):
        soup_reward[chef] = 0.0
        partial_reward[chef] = 0.0
        if actions[chef] == INTERACT:
            front = plan.front[position[chef], facing[chef]]
            code, item = cells[front], held[chef]
            outcome = plan.outcomes[code, item]
            new_code, new_item = outcome & _CELL_MASK, (outcome >> _CELL_BITS) & _ITEM_MASK
            done = outcome >> (_CELL_BITS + _ITEM_BITS)
            if events.shape[0]:
                full, wanting = count_pots(cells, plan.pots, changed, code_before)
                useful = new_item == DISH and dish_is_useful(cells, held, wanting)
                record_interaction(
                    *(events[chef], code, new_code, item, new_item, plan.pots.shape[0], full),
                    *(held[1 - chef], useful, plan.potential),
                )
            if done & POTTED:
                partial_reward[chef] = POTTING_REWARD
            elif done & PLATED:
                partial_reward[chef] = PLATING_REWARD
            elif done & SERVED:
                soup_reward[chef] = plan.soup_rewards[item]
            elif done & TOOK_DISH:
                full, wanting = count_pots(cells, plan.pots, changed, code_before)
                if dish_is_useful(cells, held, wanting):
                    partial_reward[chef] = USEFUL_DISH_REWARD
            elif done & STARTED:
                remaining[plan.pot_at[front]] = plan.cook_times[code - POT_IDLE]
            cells[front] = new_code
            held[chef] = new_item
            if new_code != code:
                paint_cell(image, front, new_code, 0, plan.paint)
                if chef == 0:
                    changed, code_before = front, code
    _move(batch, plan, i, actions, before_0, before_1)
    for p in range(plan.pots.shape[0]):
        pot = plan.pots[p]
        code = cells[pot]
        if plan.starts_itself[code]:
            remaining[p] = plan.cook_times[code - POT_IDLE]
            code += POT_COOKING - POT_IDLE
            cells[pot] = code
        if POT_COOKING < code <= POT_READY:
            remaining[p] -= 1
            if remaining[p] == 0:
                code += POT_READY - POT_COOKING
                cells[pot] = code
            paint_cell(image, pot, code, remaining[p], plan.paint)
    batch.timestep[i] += 1


@jit
def _move(batch: Batch, plan: Plan, i: int, actions: NDArray[np.int64], before_0: int, before_1: int) -> None:
    """Moves both chefs at once; a collision or a swap keeps both where they are, but everybody turns."""
    position, facing, held, image = batch.position[i], batch.facing[i], batch.held[i], batch.image[i]
    old_0, old_1 = position[0], position[1]
    new_0, new_1 = plan.target[old_0, actions[0]], plan.target[old_1, actions[1]]
    if new_0 == new_1 or (new_0 == old_1 and new_1 == old_0):
        new_0, new_1 = old_0, old_1
    position[0], position[1] = new_0, new_1
    for chef in range(2):
        if actions[chef] < STAY:
            facing[chef] = actions[chef]
    if before_0:
        paint_cell(image, old_0, FLOOR, 0, plan.paint)
    if before_1:
        paint_cell(image, old_1, FLOOR, 0, plan.paint)
    if held[0]:
        paint_cell(image, new_0, COUNTER + held[0], 0, plan.paint)
    if held[1]:
        paint_cell(image, new_1, COUNTER + held[1], 0, plan.paint)
