"""Random small kitchens, legal states and joint actions for the laws."""

from typing import Any

import numpy as np
from hypothesis import HealthCheck, assume, settings
from hypothesis import strategies as st

from overcooked_bench import Chef, KitchenState, Layout, LayoutError, Soup
from overcooked_bench.kitchen.codes import RECIPES
from overcooked_bench.kitchen.state import FACINGS

COOKING = st.sampled_from(["auto", "manual"])


def ingredients(recipe: tuple[int, int]) -> list[str]:
    return ["onion"] * recipe[0] + ["tomato"] * recipe[1]


@st.composite
def menus(draw: st.DrawFn, cooking: str, tomatoes: bool) -> dict[str, Any]:
    """The arguments of `Layout.from_text` other than the grid."""
    allowed = [
        recipe for recipe in RECIPES[1:] if (sum(recipe) == 3 or cooking == "manual") and (tomatoes or not recipe[1])
    ]
    orders = draw(st.lists(st.sampled_from(allowed), min_size=1, max_size=4, unique=True))
    bonus = [order for order in orders if draw(st.integers(0, 3)) == 0]

    def numbers(low: int, high: int) -> st.SearchStrategy[Any]:
        one = st.integers(low, high)
        each = st.fixed_dictionaries({"onion": st.integers(low, high // 3), "tomato": st.integers(low, high // 3)})
        return st.one_of(one, each, st.lists(one, min_size=len(orders), max_size=len(orders)))

    return {
        "orders": [ingredients(order) for order in orders],
        "bonus_orders": [ingredients(order) for order in bonus],
        "order_bonus": draw(st.sampled_from([2, 3])),
        "soup_reward": draw(numbers(1, 60)),
        "cook_time": draw(numbers(1, 25)),
    }


@st.composite
def grids(draw: st.DrawFn, tomatoes: bool, start_cells: bool = False) -> str:
    """A grid of at most 6 by 5 tiles; what is missing for a soup is rare."""
    width, height = draw(st.integers(4, 6)), draw(st.integers(3, 5))
    edge = [(x, y) for x in range(width) for y in range(height) if x in (0, width - 1) or y in (0, height - 1)]
    inner = [(x, y) for y in range(1, height - 1) for x in range(1, width - 1)]
    walls = [(x, y) for x, y in edge if 0 < x < width - 1 or 0 < y < height - 1]
    needed = "PDSO" + "T" * tomatoes
    grid = {place: draw(st.sampled_from("XXXPODS" + "T" * tomatoes)) for place in edge}
    grid |= {place: draw(st.sampled_from("      XP")) for place in inner}
    grid |= dict(zip(draw(st.permutations(walls)), needed, strict=False))
    if start_cells:
        floor = [place for place in inner if grid[place] == " "]
        assume(len(floor) >= 2)
        grid |= dict(zip(draw(st.permutations(floor))[:2], "12", strict=True))
    return "\n".join("".join(grid[x, y] for x in range(width)) for y in range(height))


@st.composite
def described_layouts(
    draw: st.DrawFn, cooking: str = "manual", tomatoes: bool | None = None, start_cells: bool = False
) -> tuple[Layout, dict[str, Any]]:
    """A small layout that `Layout` accepts, and the menu it was made with; tomatoes None leaves them to chance."""
    tomatoes = draw(st.booleans()) if tomatoes is None else tomatoes
    menu = draw(menus(cooking, tomatoes))
    try:
        return Layout.from_text(draw(grids(tomatoes, start_cells)), **menu), menu
    except LayoutError:
        assume(False)
        raise


def layouts(
    cooking: str = "manual", tomatoes: bool | None = None, start_cells: bool = False
) -> st.SearchStrategy[Layout]:
    """A small layout that `Layout` accepts."""
    return described_layouts(cooking, tomatoes, start_cells).map(lambda described: described[0])


def soups(layout: Layout, in_pot: bool = False) -> st.SearchStrategy[Soup]:
    """A finished soup, or one in any condition a pot can hold."""
    recipes = RECIPES[1:] if layout.has_tomatoes else [recipe for recipe in RECIPES[1:] if not recipe[1]]

    def cooked(recipe: tuple[int, int]) -> st.SearchStrategy[Soup]:
        time = layout.cook_times[RECIPES.index(recipe)]
        if not in_pot:
            return st.just(Soup(recipe, time, time))
        return st.integers(-1, time).map(lambda tick: Soup(recipe, tick, time) if tick >= 0 else Soup(recipe))

    return st.sampled_from(recipes).flatmap(cooked)


@st.composite
def states(draw: st.DrawFn, layout: Layout, horizon: int = 400) -> KitchenState:
    """Any legal state of a layout that is not over: chefs anywhere, things on counters, pots in any condition."""
    loose = ["onion", "dish", *(["tomato"] if layout.has_tomatoes else [])]
    things = st.one_of(st.sampled_from(loose), soups(layout))
    cells = draw(st.permutations(layout.positions(" ")))[:2]
    chefs = [Chef(cell, draw(st.sampled_from(FACINGS)), draw(st.none() | things)) for cell in cells]
    objects = {
        place: draw(soups(layout, in_pot=True) if layout.tile(place) == "P" else things)
        for place in layout.positions("XP")
        if draw(st.integers(0, 2)) == 0
    }
    timestep = draw(st.integers(0, horizon - 1))
    return KitchenState((chefs[0], chefs[1]), objects, timestep, layout.orders, layout.bonus_orders)


SEEDS = st.integers(0, 2**32 - 1)


def joint_actions(seed: int, steps: int, kitchens: int = 1) -> np.ndarray:
    """Random joint actions, (steps, kitchens, 2), two fifths of them interactions."""
    chances = [0.14, 0.14, 0.14, 0.14, 0.04, 0.4]
    return np.random.default_rng(seed).choice(6, size=(steps, kitchens, 2), p=chances)


law = settings(max_examples=30, deadline=None, suppress_health_check=[HealthCheck.too_slow])
"""How the laws are tried: the first example may have to compile a kernel."""
