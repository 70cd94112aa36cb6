import numpy as np
import pytest

from overcooked_bench import Chef, Kitchens, KitchenState, Layout, Soup
from overcooked_bench.scenarios.language.counters import Counter, count_step

ROOM = Layout.load("cramped_room")
SOUP = Soup((3, 0), 20, 20)
NORTH, SOUTH, EAST, WEST, STAY, INTERACT = range(6)


def counted(counters, chef, objects=None, action=INTERACT, mate=None, mate_action=STAY, seat=0):
    """What one step adds to counters; the chef sits on `seat`."""
    mate = mate or Chef((3, 2))
    kitchens = Kitchens(ROOM, 1, actions_taken=True)
    kitchens.set_state(0, KitchenState((chef, mate) if seat == 0 else (mate, chef), objects or {}))
    joint = np.array([[action, mate_action] if seat == 0 else [mate_action, action]])
    taken = kitchens.step(joint).actions_taken
    return count_step(counters, np.array([seat]), kitchens.tables, kitchens.batch.rows, taken)[0].tolist()


EVENTS = {
    "pot": (Chef((2, 1), "north", "onion"), {}, Counter("pot", "A", "onion", 1)),
    "plate": (Chef((2, 1), "north", "dish"), {(2, 0): SOUP}, Counter("plate", "A", at=1)),
    "serve": (Chef((3, 2), "south", SOUP), {}, Counter("serve", "A")),
    "pick_onion": (Chef((1, 1), "west"), {}, Counter("pick", "A", "onion")),
    "pick_dish": (Chef((1, 2), "south"), {}, Counter("pick", "A", "dish")),
    "pick_soup": (Chef((1, 1), "north"), {(1, 0): SOUP}, Counter("pick", "A", "soup")),
    "drop": (Chef((1, 1), "north", "onion"), {}, Counter("drop", "A", "onion")),
}
ALL = [Counter(event, chef) for event in ("pot", "plate", "serve", "pick", "drop") for chef in "AB"]


@pytest.mark.parametrize(("chef", "objects", "counter"), EVENTS.values(), ids=EVENTS.keys())
@pytest.mark.parametrize("seat", [0, 1])
def test_an_event_belongs_to_who_caused_it(chef, objects, counter, seat):
    mate = Chef((1, 2) if chef.position == (3, 2) else (3, 2))
    if chef.position == (1, 2):
        mate = Chef((3, 1))
    assert counted([counter], chef, objects, mate=mate, seat=seat) == [1]
    expected = [int((c.event, c.chef) == (counter.event, "A")) for c in ALL]
    assert counted(ALL, chef, objects, mate=mate, seat=seat) == expected
    theirs = [int((c.event, c.chef) == (counter.event, "B")) for c in ALL]
    got = counted(ALL, mate, objects, action=STAY, mate=chef, mate_action=INTERACT, seat=seat)
    assert got == theirs


def test_a_thing_or_a_pot_narrows_a_count():
    chef = Chef((1, 1), "west")
    assert counted([Counter("pick", "A", "dish"), Counter("pick", "A", "onion")], chef) == [0, 1]


def test_nothing_happens_where_an_interaction_does_nothing():
    assert counted(ALL, Chef((1, 1), "west", "dish")) == [0] * len(ALL)
    assert counted(ALL, Chef((2, 1), "north", "onion"), {(2, 0): SOUP}) == [0] * len(ALL)


def test_the_score_is_the_teams():
    serves = Chef((3, 2), "south", SOUP)
    assert counted([Counter("score")], serves, mate=Chef((1, 1))) == [20]
    assert counted([Counter("score")], Chef((1, 1)), action=STAY, mate=serves, mate_action=INTERACT) == [20]


def test_blocked_is_by_the_other_chef_alone():
    counters = [Counter("blocked", "A"), Counter("blocked", "B")]
    left, right = Chef((1, 1), "east"), Chef((2, 1), "west")
    assert counted(counters, left, action=EAST, mate=right) == [1, 0]
    assert counted(counters, left, action=EAST, mate=right, mate_action=WEST) == [1, 1]
    assert counted(counters, left, action=WEST, mate=right) == [0, 0]
    assert counted(counters, left, action=EAST, mate=right, mate_action=SOUTH) == [0, 0]
    assert counted(counters, left, action=INTERACT, mate=right) == [0, 0]
