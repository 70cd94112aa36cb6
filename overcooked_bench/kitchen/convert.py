"""Converts between the batch's arrays and the readable `KitchenState`, both ways and exactly."""

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.kitchen.batch import Batch
from overcooked_bench.kitchen.codes import (
    COUNTER,
    DISH,
    FLOOR,
    NOTHING,
    NUM_ITEMS,
    ONION,
    POT_COOKING,
    POT_IDLE,
    POT_READY,
    RECIPES,
    SOUP,
    TOMATO,
    Position,
    pot_recipe,
)
from overcooked_bench.kitchen.errors import StateError, said
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import FACINGS, Chef, KitchenState, Soup, Thing, row_major
from overcooked_bench.kitchen.tables import Tables

_NAMES: dict[int, Thing] = {ONION: "onion", TOMATO: "tomato", DISH: "dish"}
_ITEMS = {name: code for code, name in _NAMES.items()}


def read_state(batch: Batch, tables: Tables, layout: Layout, i: int) -> KitchenState:
    """Returns kitchen i of a batch as a KitchenState."""
    width = layout.width

    def place(cell: int) -> Position:
        return int(cell) % width, int(cell) // width

    def thing(item: int) -> Thing:
        if item <= SOUP:
            return _NAMES[item]
        time = layout.cook_times[item - SOUP]
        return Soup(RECIPES[item - SOUP], time, time)

    objects: dict[Position, Thing] = {}
    pots = tables.pots.tolist()
    for cell, code in enumerate(batch.cells[i].tolist()):
        if COUNTER < code < COUNTER + NUM_ITEMS:
            objects[place(cell)] = thing(code - COUNTER)
        elif code > POT_IDLE:
            recipe = pot_recipe(code)
            time = layout.cook_times[recipe]
            left = int(batch.remaining[i, pots.index(cell)])
            objects[place(cell)] = (
                Soup(RECIPES[recipe], time - left, time) if code > POT_COOKING else Soup(RECIPES[recipe])
            )
    chefs = [
        Chef(
            place(batch.position[i, k]),
            FACINGS[batch.facing[i, k]],
            None if batch.held[i, k] == NOTHING else thing(int(batch.held[i, k])),
        )
        for k in range(2)
    ]
    return KitchenState((chefs[0], chefs[1]), objects, int(batch.clock[i]), layout.orders, layout.bonus_orders)


def write_state(batch: Batch, tables: Tables, layout: Layout, i: int, state: KitchenState, horizon: int) -> None:
    """Puts a KitchenState into kitchen i of a batch, except its image.

    Cook times come from the layout; a state's own are only used to say how long a soup has cooked.

    Raises:
        StateError: The state is not legal in this layout; nothing was changed then.
    """
    for wanted, given, what in (
        (layout.orders, state.orders, "orders"),
        (layout.bonus_orders, state.bonus_orders, "bonus"),
    ):
        if given is not None and state.orders is not None and set(given) != set(wanted):
            raise StateError(
                f"the state's {what} are {sorted(given)} (onions, tomatoes), the layout's {sorted(wanted)}"
            )
    if not _is_whole(state.timestep) or not 0 <= state.timestep <= horizon:
        raise StateError(f"timestep {said(state.timestep)}; the horizon is {horizon} steps")
    cells, remaining = _place_objects(tables, layout, state)
    position, facing, held = _place_chefs(tables, layout, state)
    batch.cells[i], batch.remaining[i] = cells, remaining
    batch.position[i], batch.facing[i], batch.held[i] = position, facing, held
    batch.clock[i] = state.timestep


def _place_objects(
    tables: Tables, layout: Layout, state: KitchenState
) -> tuple[NDArray[np.uint16], NDArray[np.uint16]]:
    """Returns the codes of all cells and the remaining steps of the pots."""
    strange = [position for position in state.objects if not _is_cell(position)]
    if strange:
        raise StateError(f"an object is at {said(strange[0])}; positions are (x, y) of whole numbers")
    cells, remaining, pots = tables.fresh.copy(), np.zeros(len(tables.pots), np.uint16), tables.pots.tolist()
    for (x, y), thing in row_major(state.objects).items():
        where = f"{_name(thing)} at ({x}, {y})"
        tile = layout.tile((x, y)) if 0 <= x < layout.width and 0 <= y < layout.height else "outside"
        cell = y * layout.width + x
        if tile == "X":
            cells[cell] = COUNTER + _item(thing, layout, where)
        elif tile == "P" and isinstance(thing, Soup):
            recipe = _recipe_index(thing, where)
            if thing.is_idle:
                cells[cell] = POT_IDLE + recipe
                continue
            left = max(0, layout.cook_times[recipe] - thing.tick)
            cells[cell] = (POT_COOKING if left else POT_READY) + recipe
            remaining[pots.index(cell)] = left
        else:
            raise StateError(f"{where}: objects are on counters (X) and soups in pots (P), and this is {tile!r}")
    return cells, remaining


def _place_chefs(tables: Tables, layout: Layout, state: KitchenState) -> tuple[list[int], list[int], list[int]]:
    """Returns both chefs' cells, directions and items."""
    if len(state.chefs) != 2 or any(not _is_cell(chef.position) for chef in state.chefs):
        raise StateError(f"chefs are {said(state.chefs)}; give two, each at (x, y) of whole numbers")
    position, facing, held = [], [], []
    for seat, chef in enumerate(state.chefs):
        x, y = chef.position
        cell = y * layout.width + x
        inside = 0 <= x < layout.width and 0 <= y < layout.height
        if not inside or tables.fresh[cell] != FLOOR:
            raise StateError(f"chef {seat} stands at ({x}, {y}), which is not floor")
        if chef.facing not in FACINGS:
            raise StateError(f"chef {seat} faces {said(chef.facing)}; directions are {', '.join(FACINGS)}")
        thing = chef.holding
        position.append(cell)
        facing.append(FACINGS.index(chef.facing))
        held.append(NOTHING if thing is None else _item(thing, layout, f"chef {seat}'s {_name(thing)}"))
    if position[0] == position[1]:
        raise StateError(f"both chefs stand at {state.chefs[0].position}")
    return position, facing, held


def _is_whole(value: object) -> bool:
    return isinstance(value, int | np.integer) and not isinstance(value, bool)


def _is_cell(position: object) -> bool:
    return isinstance(position, tuple) and len(position) == 2 and all(_is_whole(part) for part in position)


def _name(thing: Thing) -> str:
    return f"soup {thing.recipe}" if isinstance(thing, Soup) else thing


def _recipe_index(soup: Soup, where: str) -> int:
    if soup.recipe not in RECIPES[1:]:
        raise StateError(f"{where}: a soup has one to three ingredients, (onions, tomatoes)")
    if soup.tick < -1:
        raise StateError(f"{where}: tick {soup.tick}; it is -1 while idle, then 0 and up")
    return RECIPES.index(soup.recipe)


def _item(thing: Thing, layout: Layout, where: str) -> int:
    if not isinstance(thing, Soup):
        if thing not in _ITEMS:
            raise StateError(f"{where}: things are 'onion', 'tomato', 'dish' and Soup(...)")
        return _ITEMS[thing]
    recipe = _recipe_index(thing, where)
    if thing.is_idle or thing.tick < (thing.cook_time if thing.cook_time >= 0 else layout.cook_times[recipe]):
        raise StateError(f"{where}: a soup outside the pots is always finished; give it tick = cook_time")
    return SOUP + recipe
