"""The encoding of 2019 against a slow one that lists objects as the kitchen of 2019 did."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench import Chef, Kitchens, KitchenState, Soup
from overcooked_bench.kitchen.observations.grid import ONION_CHANNELS
from overcooked_bench.kitchen.state import FACINGS
from tests.kitchen.strategies import COOKING, SEEDS, joint_actions, law, layouts

PLANES = (
    *("own_position", "other_position"),
    *("own_north", "own_south", "own_east", "own_west", "other_north", "other_south", "other_east", "other_west"),
    *("pots", "counters", "onion_dispensers", "dish_dispensers", "serving_tiles"),
    *("onions_in_pot", "cooked", "soups", "dishes", "onions"),
)


def by_kind(placed):
    kinds = {}
    for place, thing in placed:
        kinds.setdefault("soup" if isinstance(thing, Soup) else thing, []).append((place, thing))
    return kinds


def encoded(layout, state, viewer):
    """A chef's view of one state, (20, H, W)."""
    view = np.zeros((20, layout.height, layout.width), int)

    def mark(plane, place, value=1):
        view[PLANES.index(plane), place[1], place[0]] += value

    for tile, plane in zip("PXODS", PLANES[10:15], strict=True):
        for place in layout.positions(tile):
            mark(plane, place)
    for chef, who in ((state.chefs[viewer], "own"), (state.chefs[1 - viewer], "other")):
        mark(f"{who}_position", chef.position)
        mark(f"{who}_{chef.facing}", chef.position)
    held = by_kind((chef.position, chef.holding) for chef in state.chefs if chef.holding is not None)
    objects = by_kind(state.objects.items()) | held  # the fault: what is held replaces all others of its kind
    for place, thing in [one for several in objects.values() for one in several]:
        if not isinstance(thing, Soup):
            mark({"onion": "onions", "dish": "dishes"}[thing], place)
        elif place in layout.positions("P"):
            mark("onions_in_pot", place, thing.recipe[0])
            mark("cooked", place, max(0, thing.tick))
        else:
            mark("soups", place)
    return view


@law
@given(data=st.data(), cooking=COOKING, seed=SEEDS)
def test_chefs_see_what_they_saw_in_2019(data, cooking, seed):
    layout = data.draw(layouts(cooking, tomatoes=False))
    kitchens = Kitchens(layout, 3, cooking=cooking, object_probability=0.5)
    kitchens.reset(seed=seed)
    for joint in joint_actions(seed, 25, kitchens=3):
        kitchens.step(joint)
        seen = kitchens.observe("lossless_2019")
        for i in range(3):
            for viewer in range(2):
                np.testing.assert_array_equal(seen[i, viewer], encoded(layout, kitchens.state(i), viewer))


def shown(view, plane):
    return {(int(x), int(y)): int(view[PLANES.index(plane), y, x]) for y, x in np.argwhere(view[PLANES.index(plane)])}


def test_what_is_held_hides_all_others_of_its_kind_from_both_chefs():
    kitchens = Kitchens("asymmetric_advantages", 1)
    objects = {
        (4, 2): Soup((3, 0), 7, 20),
        (4, 3): Soup((2, 0)),
        (1, 0): "onion",
        (7, 0): "dish",
        (2, 0): Soup((3, 0), 20, 20),
    }
    first, second = (chef.position for chef in kitchens.state(0).chefs)

    def views(*held):
        chefs = (Chef(first, FACINGS[0], held[0]), Chef(second, FACINGS[0], held[1]))
        kitchens.set_state(0, KitchenState(chefs, objects, timestep=380))
        own, other = kitchens.observe("lossless_2019")[0]
        np.testing.assert_array_equal(own[10:], other[10:])
        return own

    nothing = views(None, None)
    assert shown(nothing, "onions_in_pot") == {(4, 2): 3, (4, 3): 2}
    assert shown(nothing, "cooked") == {(4, 2): 7}
    assert shown(nothing, "soups") == {(2, 0): 1}
    assert (shown(nothing, "onions"), shown(nothing, "dishes")) == ({(1, 0): 1}, {(7, 0): 1})
    with_soup = views(Soup((3, 0), 20, 20), None)
    assert (shown(with_soup, "onions_in_pot"), shown(with_soup, "cooked")) == ({}, {})
    assert shown(with_soup, "soups") == {first: 1}
    assert (shown(with_soup, "onions"), shown(with_soup, "dishes")) == ({(1, 0): 1}, {(7, 0): 1})
    with_both = views("dish", "onion")
    assert shown(with_both, "onions_in_pot") == shown(nothing, "onions_in_pot"), "onions in pots are soups"
    assert (shown(with_both, "onions"), shown(with_both, "dishes")) == ({second: 1}, {first: 1})
    lossless = kitchens.observe("lossless")[0, 0]
    assert lossless[ONION_CHANNELS.index(23), 0, 1] == 1, "ours shows the onion on the counter, too"
