"""A small stage for examples of the rules: put chefs and things somewhere, play named actions, see what happened."""

from typing import Any

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, Soup, StepResult
from overcooked_bench.kitchen.codes import ACTION_NAMES
from overcooked_bench.kitchen.events import EVENTS

GRID = """
XXPPXX
O    T
D    S
X    X
XXXXXX
"""
LEFT_POT, RIGHT_POT = (2, 0), (3, 0)
COUNTER = (1, 4)

# Where to stand, and what to face from there.
AT_LEFT_POT, AT_RIGHT_POT = ((2, 1), "north"), ((3, 1), "north")
AT_ONIONS, AT_TOMATOES = ((1, 1), "west"), ((4, 1), "east")
AT_DISHES, AT_SERVING = ((1, 2), "west"), ((4, 2), "east")
AT_COUNTER, AWAY = ((1, 3), "south"), ((4, 3), "south")
"""COUNTER is faced by AT_COUNTER alone."""

SOUP = Soup((3, 0), 20, 20)
"""A finished three-onion soup."""


def chef(place: tuple[tuple[int, int], str], holding: Any = None) -> Chef:
    return Chef(*place, holding)


def stage(
    first: Chef, second: Chef, objects: Any = None, cooking: str = "auto", grid: str = GRID, **menu: Any
) -> Kitchens:
    """One kitchen with the chefs and things where they are wanted."""
    options = {"events": True, "actions_taken": True, "autoreset": False}
    kitchens = Kitchens(Layout.from_text(grid, **menu), 1, cooking=cooking, **options)
    kitchens.set_state(0, KitchenState((first, second), objects or {}))
    return kitchens


def act(kitchens: Kitchens, first: str = "stay", second: str = "stay") -> StepResult:
    """Plays one joint action."""
    return kitchens.step([[ACTION_NAMES.index(first), ACTION_NAMES.index(second)]])


def held(kitchens: Kitchens) -> list[Any]:
    return [chef.holding for chef in kitchens.state(0).chefs]


def objects(kitchens: Kitchens) -> dict[Any, Any]:
    return dict(kitchens.state(0).objects)


def places(kitchens: Kitchens) -> list[tuple[int, int]]:
    return [chef.position for chef in kitchens.state(0).chefs]


def facings(kitchens: Kitchens) -> list[str]:
    return [chef.facing for chef in kitchens.state(0).chefs]


def logged(result: StepResult, seat: int) -> set[str]:
    """Names of a chef's events."""
    assert result.events is not None
    return {name for name, flag in zip(EVENTS, result.events[0, seat], strict=True) if flag}
