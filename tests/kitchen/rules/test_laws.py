"""Laws of the game, tried in random small kitchens from random states."""

from collections import Counter
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, Soup
from overcooked_bench.kitchen.codes import DIRECTIONS, INTERACT, RECIPES
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.kitchen.state import FACINGS
from tests.kitchen.strategies import COOKING, SEEDS, joint_actions, law, layouts, states

EAST_WEST = np.array([0, 1, 3, 2, 4, 5])
MIRRORED_VIEW = [0, 1, 2, 3, 5, 4, 6, 7, 9, 8, *range(10, 26)]
SWAPPED_VIEW = [1, 0, 6, 7, 8, 9, 2, 3, 4, 5, *range(10, 26)]
STEPS = 25


def kitchen_in(state: KitchenState, layout: Layout, cooking: str) -> Kitchens:
    """One kitchen in a state, with events and without autoreset."""
    kitchens = Kitchens(layout, 1, cooking=cooking, events=True)
    kitchens.autoreset = False
    kitchens.set_state(0, state)
    return kitchens


def played(kitchens: Kitchens, seed: int):
    """Plays random joint actions to the horizon or for 25 steps; yields (state before, actions, result)."""
    for joint in joint_actions(seed, STEPS):
        before = kitchens.state(0)
        if before.timestep == kitchens.horizon:
            return
        yield before, joint[0], kitchens.step(joint)


def faced_tile(layout: Layout, chef: Chef) -> str:
    dx, dy = DIRECTIONS[FACINGS.index(chef.facing)]
    return layout.tile((chef.position[0] + dx, chef.position[1] + dy))


def contents(layout: Layout, state: KitchenState) -> Counter:
    """Counts onions, tomatoes and dishes; a soup is its ingredients, and outside the pots also a dish."""
    found = Counter()
    things = [(thing, layout.tile(place) != "P") for place, thing in state.objects.items()]
    for thing, plated in [*things, *((chef.holding, True) for chef in state.chefs)]:
        if isinstance(thing, Soup):
            found.update(onion=thing.recipe[0], tomato=thing.recipe[1], dish=int(plated))
        elif thing is not None:
            found[thing] += 1
    return found


@law
@given(st.data(), COOKING, SEEDS)
def test_things_come_from_dispensers_and_leave_by_the_serving_tile_only(data, cooking, seed):
    layout = data.draw(layouts(cooking))
    kitchens = kitchen_in(data.draw(states(layout)), layout, cooking)
    for before, actions, result in played(kitchens, seed):
        expected, paid = contents(layout, before), [0.0, 0.0]
        for seat, chef in enumerate(before.chefs):
            tile = faced_tile(layout, chef) if actions[seat] == INTERACT else ""
            if chef.holding is None and tile in ("O", "T", "D"):
                expected[{"O": "onion", "T": "tomato", "D": "dish"}[tile]] += 1
            elif isinstance(chef.holding, Soup) and tile == "S":
                onions, tomatoes = chef.holding.recipe
                expected -= Counter(onion=onions, tomato=tomatoes, dish=1)
                paid[seat] = layout.soup_rewards[RECIPES.index(chef.holding.recipe)]
        assert +contents(layout, kitchens.state(0)) == +expected
        assert result.soup_reward[0].tolist() == paid


@law
@given(st.data(), COOKING, SEEDS)
def test_the_two_views_differ_by_the_swap_of_the_chefs_channels(data, cooking, seed):
    layout = data.draw(layouts(cooking))
    kitchens = kitchen_in(data.draw(states(layout)), layout, cooking)
    for _ in played(kitchens, seed):
        first, second = kitchens.observe("lossless26")[0]
        np.testing.assert_array_equal(first[SWAPPED_VIEW], second)


def mirrored_state(state: KitchenState, layout: Layout) -> KitchenState:
    def mirrored(place):
        return layout.width - 1 - place[0], place[1]

    turned = {"east": "west", "west": "east"}
    chefs = [Chef(mirrored(c.position), turned.get(c.facing, c.facing), c.holding) for c in state.chefs]
    objects = {mirrored(place): thing for place, thing in state.objects.items()}
    return replace(state, chefs=(chefs[0], chefs[1]), objects=objects)


@law
@given(st.data(), COOKING, SEEDS)
def test_mirrored_kitchens_play_mirrored_games(data, cooking, seed):
    layout = data.draw(layouts(cooking))
    state = data.draw(states(layout))
    kitchens = kitchen_in(state, layout, cooking)
    mirror = kitchen_in(mirrored_state(state, layout), layout.mirrored(), cooking)
    for _, actions, result in played(kitchens, seed):
        reflected = mirror.step(EAST_WEST[actions][None])
        for ours, theirs in zip(result, reflected, strict=True):
            np.testing.assert_array_equal(ours, theirs)
        assert mirror.state(0) == mirrored_state(kitchens.state(0), layout)
        seen, seen_mirrored = kitchens.observe("lossless26"), mirror.observe("lossless26")
        np.testing.assert_array_equal(seen[:, :, MIRRORED_VIEW, :, ::-1], seen_mirrored)


@pytest.mark.parametrize("name", layout_names())
def test_a_mirrored_name_is_the_mirrored_kitchen(name):
    plain, mirror = (Kitchens(given, 1, start="standard") for given in (name, f"{name}-mirrored"))
    for joint in joint_actions(seed=1, steps=60):
        for ours, theirs in zip(plain.step(joint)[:3], mirror.step(EAST_WEST[joint])[:3], strict=True):
            np.testing.assert_array_equal(ours, theirs)
        np.testing.assert_array_equal(
            plain.observe("lossless26")[:, :, MIRRORED_VIEW, :, ::-1], mirror.observe("lossless26")
        )


@law
@given(st.data(), COOKING, SEEDS)
def test_chefs_stay_on_the_floor_and_never_meet(data, cooking, seed):
    layout = data.draw(layouts(cooking))
    kitchens = kitchen_in(data.draw(states(layout)), layout, cooking)
    for before, actions, _ in played(kitchens, seed):
        after = kitchens.state(0)
        assert after.chefs[0].position != after.chefs[1].position
        assert after.timestep == before.timestep + 1
        for chef, was, action in zip(after.chefs, before.chefs, actions, strict=True):
            assert layout.tile(chef.position) == " "
            moved = (chef.position[0] - was.position[0], chef.position[1] - was.position[1])
            assert moved in ((0, 0), *DIRECTIONS[action : action + 1])
            assert chef.facing == (FACINGS[action] if action < 4 else was.facing)


@law
@given(st.data(), COOKING, SEEDS)
def test_every_state_met_in_play_is_legal(data, cooking, seed):
    layout = data.draw(layouts(cooking))
    kitchens = kitchen_in(data.draw(states(layout)), layout, cooking)
    for _ in played(kitchens, seed):
        state = kitchens.state(0)
        for place, thing in state.objects.items():
            assert layout.tile(place) in ("P" if isinstance(thing, Soup) else "") + "X"
            if isinstance(thing, Soup):
                assert thing.is_ready or layout.tile(place) == "P"
                assert thing.is_idle or thing.cook_time == layout.cook_times[RECIPES.index(thing.recipe)]
        kitchen_in(state, layout, cooking)


@law
@given(st.data(), COOKING)
def test_pots_cook_by_the_clock(data, cooking):
    layout = data.draw(layouts(cooking))
    state = replace(data.draw(states(layout)), timestep=0)
    kitchens = kitchen_in(state, layout, cooking)
    pots = {place: thing for place, thing in state.objects.items() if layout.tile(place) == "P"}
    for step in range(1, 30):
        kitchens.step([[4, 4]])
        now = kitchens.state(0).objects
        for place, soup in pots.items():
            starts = cooking == "auto" and sum(soup.recipe) == 3
            if soup.is_idle and not starts:
                assert now[place] == soup
            else:
                time = layout.cook_times[RECIPES.index(soup.recipe)]
                assert now[place] == Soup(soup.recipe, min(time, max(soup.tick, 0) + step), time)
