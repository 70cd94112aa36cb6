"""Integer codes of items, cells, actions and directions inside a batch of kitchens.

Every object and every content of a cell has one code, so that the rules of the game can be a table.

Source: actions, directions and recipes follow overcooked_ai (`mdp/actions.py`, `mdp/overcooked_mdp.py`).
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

Recipe = tuple[int, int]
"""The content of a pot or soup: (onions, tomatoes)."""

Position = tuple[int, int]
"""(x, y): x = column to the right, y = row downwards, (0, 0) top left."""

NUM_ACTIONS: Final = 6
NORTH, SOUTH, EAST, WEST, STAY, INTERACT = range(NUM_ACTIONS)
ACTION_NAMES: Final = ("north", "south", "east", "west", "stay", "interact")
"""Actions 0 to 5 in Python; the first four are directions too."""
PICTURE_NAMES: Final = ("up", "down", "right", "left", "stay", "interact")
"""The same in files and pictures, where a kitchen is seen from above."""
ACTION_LETTERS: Final = "UDRLSI"
"""The same as one letter each."""
DIRECTIONS: Final[tuple[Position, ...]] = ((0, -1), (0, 1), (1, 0), (-1, 0))

RECIPES: Final[tuple[Recipe, ...]] = (
    (0, 0),  # index 0: an empty pot; never a soup
    *((1, 0), (0, 1)),
    *((2, 0), (1, 1), (0, 2)),
    *((3, 0), (2, 1), (1, 2), (0, 3)),
)
NUM_RECIPES: Final = len(RECIPES)
MAX_INGREDIENTS: Final = 3

# What a chef holds or a counter carries: nothing, an ingredient, a dish, or a finished soup SOUP + recipe index.
NOTHING, ONION, TOMATO, DISH = range(4)
SOUP: Final = DISH  # + recipe index, from 1: every code greater than SOUP is a soup
NUM_ITEMS: Final = SOUP + NUM_RECIPES

# A cell's tile together with what is on it.
FLOOR: Final = 0
COUNTER: Final = 1  # + item
ONION_DISPENSER: Final = COUNTER + NUM_ITEMS
TOMATO_DISPENSER: Final = ONION_DISPENSER + 1
DISH_DISPENSER: Final = ONION_DISPENSER + 2
SERVING: Final = ONION_DISPENSER + 3
POT_IDLE: Final = ONION_DISPENSER + 4  # + recipe index; + 0 is an empty pot
POT_COOKING: Final = POT_IDLE + NUM_RECIPES - 1  # + recipe index, from 1
POT_READY: Final = POT_COOKING + NUM_RECIPES - 1  # + recipe index, from 1
NUM_CELL_CODES: Final = POT_READY + NUM_RECIPES

TILES: Final = {
    " ": FLOOR,
    "X": COUNTER,
    "O": ONION_DISPENSER,
    "T": TOMATO_DISPENSER,
    "D": DISH_DISPENSER,
    "S": SERVING,
    "P": POT_IDLE,
}
TILE_NAMES: Final = {
    "X": "counter",
    "O": "onion dispenser",
    "T": "tomato dispenser",
    "D": "dish dispenser",
    "S": "serving tile",
    "P": "pot",
}


# The action that a chef took in one step, as bits; the item concerned is written above them.
POTTED: Final = 1  # put an ingredient into a pot
PLATED: Final = 2  # took a soup out of a pot
SERVED: Final = 4  # delivered a soup
TOOK_DISH: Final = 8  # took a dish out of a dispenser, which is also TOOK
STARTED: Final = 16  # made a pot cook
TOOK: Final = 32  # took something out of a dispenser
PICKED_UP: Final = 64  # took something from a counter
PUT_DOWN: Final = 128  # put something on a counter
BLOCKED: Final = 256  # wanted to walk to a floor cell and was kept out of it by the other chef
DONE_BITS: Final = 9


def item_of(taken: NDArray[np.uint16]) -> NDArray[np.uint16]:
    """Returns the code of the item of each action taken: the one that was taken, or else the one that was put away."""
    return taken >> np.uint16(DONE_BITS)


def is_pot(code: int) -> bool:
    """Returns whether a cell code is a pot in any condition."""
    return code >= POT_IDLE


def pot_recipe(code: int) -> int:
    """Returns the recipe index of a pot's content, 0 for an empty pot."""
    if code > POT_READY:
        return code - POT_READY
    if code > POT_COOKING:
        return code - POT_COOKING
    return code - POT_IDLE
