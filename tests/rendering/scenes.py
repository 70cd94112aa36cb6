"""States that differ in one thing, and played episodes, for the tests of pictures, text and replays."""

from dataclasses import replace

import numpy as np
from hypothesis import strategies as st
from numpy.typing import NDArray

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, Soup
from overcooked_bench.kitchen.codes import RECIPES
from overcooked_bench.kitchen.state import FACINGS, Thing

TOMATO_KITCHEN = Layout.from_text(
    """
    XXPXPXX
    O     T
    X1   2X
    X     S
    XXDXXXX
    """,
    orders=[["onion", "tomato"], ["onion"] * 3],
    cook_time=[120, 15],
)
POTS = TOMATO_KITCHEN.positions("P")
COUNTERS = TOMATO_KITCHEN.positions("X")

finished = st.sampled_from([Soup(recipe, 20, 20) for recipe in RECIPES[1:]])
things = st.sampled_from(["onion", "tomato", "dish"]) | finished


@st.composite
def pot_contents(draw: st.DrawFn) -> Soup:
    recipe = draw(st.sampled_from(RECIPES[1:]))
    cook_time = TOMATO_KITCHEN.cook_times[RECIPES.index(recipe)]
    tick = draw(st.integers(-1, cook_time))
    return Soup(recipe, tick, cook_time if tick >= 0 else -1)


@st.composite
def states(draw: st.DrawFn) -> KitchenState:
    cells = draw(st.permutations(TOMATO_KITCHEN.positions(" ")))[:2]
    chefs = [Chef(cell, draw(st.sampled_from(FACINGS)), draw(st.none() | things)) for cell in cells]
    objects: dict[tuple[int, int], Thing] = draw(st.dictionaries(st.sampled_from(COUNTERS), things, max_size=4))
    objects |= draw(st.dictionaries(st.sampled_from(POTS), pot_contents(), max_size=2))
    return KitchenState((chefs[0], chefs[1]), objects, draw(st.integers(0, 399)))


@st.composite
def neighbours(draw: st.DrawFn) -> tuple[KitchenState, KitchenState]:
    """Two states that differ in one thing that can be seen."""
    state = draw(states())
    seat, kind = draw(st.integers(0, 1)), draw(st.sampled_from(["hands", "facing", "place", "seats", "pot", "counter"]))
    chef = state.chefs[seat]
    if kind == "seats":
        first, second = state.chefs
        return state, replace(
            state, chefs=(replace(first, position=second.position), replace(second, position=first.position))
        )
    if kind in ("pot", "counter"):
        place = draw(st.sampled_from(POTS if kind == "pot" else COUNTERS))
        before = state.objects.get(place)
        contents = pot_contents() if kind == "pot" else things
        content = draw((st.none() | contents).filter(lambda content: content != before))
        objects = {at: thing for at, thing in state.objects.items() if at != place}
        return state, replace(state, objects=objects if content is None else {**objects, place: content})
    if kind == "hands":
        chef = replace(chef, holding=draw((st.none() | things).filter(lambda thing: thing != chef.holding)))
    elif kind == "facing":
        chef = replace(chef, facing=draw(st.sampled_from([facing for facing in FACINGS if facing != chef.facing])))
    else:
        taken = [other.position for other in state.chefs]
        free = [cell for cell in TOMATO_KITCHEN.positions(" ") if cell not in taken]
        chef = replace(chef, position=draw(st.sampled_from(free)))
    chefs = (chef, state.chefs[1]) if seat == 0 else (state.chefs[0], chef)
    return state, replace(state, chefs=chefs)


def some_state(layout: Layout) -> KitchenState:
    """The chefs in the first two floor cells, one with a soup, and something on the first counter."""
    first, second = layout.positions(" ")[:2]
    chefs = Chef(first, "south", Soup((3, 0), 20, 20)), Chef(second, "west")
    return KitchenState(chefs, {layout.positions("X")[0]: "onion", layout.positions("P")[0]: Soup((3, 0), 5, 20)}, 7)


def played(layout: str, steps: int, cooking: str = "auto") -> tuple[KitchenState, NDArray[np.int64], float]:
    """An episode that starts beside success: chef 0 holds a soup before a serving tile.

    Returns:
        The first state, (steps, 2) joint actions, the points earned.
    """
    kitchens = Kitchens(layout, 1, cooking=cooking, horizon=400)
    kitchens.autoreset = False
    plan = kitchens.layout
    x, y = plan.positions("S")[0]
    sides = {"south": (x, y - 1), "north": (x, y + 1), "east": (x - 1, y), "west": (x + 1, y)}
    facing, cell = next((facing, cell) for facing, cell in sides.items() if cell in plan.regions)
    other = next(spot for spot in reversed(plan.positions(" ")) if spot != cell)
    kitchens.set_state(0, KitchenState((Chef(cell, facing, Soup((3, 0), 20, 20)), Chef(other))))
    start = kitchens.state(0)
    actions = np.random.default_rng(3).integers(0, 6, (steps, 2))
    actions[0, 0] = 5
    points = sum(float(kitchens.step(row[None]).soup_reward.sum()) for row in actions)
    return start, actions, points
