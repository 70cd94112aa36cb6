"""What each chef did, as the step writes it, against what two states and the joint action tell."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from overcooked_bench import Kitchens, Soup
from overcooked_bench.kitchen import codes
from overcooked_bench.kitchen.codes import DIRECTIONS, INTERACT, item_of
from tests.kitchen.staging import AT_COUNTER, AT_SERVING, AWAY, SOUP, act, chef, stage
from tests.kitchen.strategies import COOKING, SEEDS, joint_actions, law, layouts

DISPENSED = {"O": "onion", "T": "tomato", "D": "dish"}
CODES = {"onion": codes.ONION, "tomato": codes.TOMATO, "dish": codes.DISH}


def code(thing) -> int:
    if isinstance(thing, Soup):
        return codes.SOUP + codes.RECIPES.index(thing.recipe)
    return 0 if thing is None else CODES[thing]


def told(layout, before, after, seat: int, action: int) -> tuple[int, int]:
    """What a chef did, and with which thing."""
    chef, later = before.chefs[seat], after.chefs[seat]
    (x, y), other = chef.position, before.chefs[1 - seat].position
    if action < 4:
        wanted = x + DIRECTIONS[action][0], y + DIRECTIONS[action][1]
        stopped = layout.tile(wanted) == " " and later.position == chef.position
        return codes.BLOCKED if stopped else 0, 0
    if action != INTERACT:
        return 0, 0
    dx, dy = DIRECTIONS[("north", "south", "east", "west").index(chef.facing)]
    tile = layout.tile((x + dx, y + dy))
    had, has = chef.holding, later.holding
    if had == has:
        faced = before.objects.get((x + dx, y + dy)), after.objects.get((x + dx, y + dy))
        started = tile == "P" and had is None and faced[0] and faced[0].is_idle and not faced[1].is_idle
        alone = other != (x + 2 * dx, y + 2 * dy)  # else the other chef may have made it the third ingredient
        return codes.STARTED if started and alone else 0, 0
    if had is None:
        if tile == "X":
            return codes.PICKED_UP, code(has)
        assert has == DISPENSED[tile]
        return codes.TOOK | (codes.TOOK_DISH if has == "dish" else 0), code(has)
    if has is None:
        return {"X": codes.PUT_DOWN, "P": codes.POTTED, "S": codes.SERVED}[tile], code(had)
    assert (had, tile) == ("dish", "P")
    return codes.PLATED, code(has)


@law
@given(data=st.data(), cooking=COOKING, seed=SEEDS)
def test_it_is_what_the_states_tell(data, cooking, seed):
    layout = data.draw(layouts(cooking, tomatoes=data.draw(st.booleans())))
    kitchens = Kitchens(layout, 2, cooking=cooking, object_probability=0.8, actions_taken=True, horizon=500)
    kitchens.reset(seed=seed)
    for joint in joint_actions(seed, 60, kitchens=2):
        before = [kitchens.state(i) for i in range(2)]
        taken = kitchens.step(joint).actions_taken
        for i in range(2):
            after = kitchens.state(i)
            for seat in range(2):
                done, thing = told(layout, before[i], after, seat, joint[i, seat])
                given = int(taken[i, seat]) % (1 << codes.DONE_BITS)
                assert given == done or {given, done} == {0, codes.STARTED}  # two chefs may press one pot's button
                assert not done or done == codes.STARTED or item_of(taken)[i, seat] == thing


def test_a_delivery_that_pays_nothing_is_one():
    kitchens = stage(chef(AT_SERVING, Soup((1, 0), 20, 20)), chef(AWAY), cooking="manual")
    result = act(kitchens, "interact")
    assert result.soup_reward.sum() == 0
    assert result.actions_taken.tolist() == [[codes.SERVED | (codes.SOUP + 1) << codes.DONE_BITS, 0]]


def test_a_pot_that_a_chef_starts():
    kitchens = stage(chef(((2, 1), "north")), chef(AWAY), {(2, 0): Soup((2, 0))}, cooking="manual")
    assert act(kitchens, "interact").actions_taken.tolist() == [[codes.STARTED, 0]]


def test_what_is_done_is_forgotten_at_the_next_step():
    kitchens = stage(chef(AT_COUNTER, SOUP), chef(AWAY))
    assert act(kitchens, "interact").actions_taken[0, 0] & codes.PUT_DOWN
    assert act(kitchens, "stay").actions_taken.tolist() == [[0, 0]]


@pytest.mark.parametrize("asked", [True, False])
def test_asking_changes_nothing(asked):
    plain, other = Kitchens("cramped_room", 3), Kitchens("cramped_room", 3, actions_taken=asked)
    plain.reset(seed=1)
    other.reset(seed=1)
    for joint in joint_actions(2, 450, kitchens=3):
        ours, theirs = plain.step(joint), other.step(joint)
        assert ours.actions_taken is None
        assert (theirs.actions_taken is not None) == asked
        np.testing.assert_array_equal(ours.soup_reward, theirs.soup_reward)
        np.testing.assert_array_equal(plain.batch.rows, other.batch.rows)
