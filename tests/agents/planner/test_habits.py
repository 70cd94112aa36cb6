"""Habits of planners: each shows in what the chef does, and none of them stops the cooking."""

from collections import Counter
from typing import NamedTuple

import numpy as np
import pytest

from overcooked_bench import Kitchens, Layout
from overcooked_bench.agents.planner.tables import FAR, make_tables
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.kitchen.codes import DIRECTIONS, DISH, ONION, PLATED, POTTED, PUT_DOWN, STAY, item_of
from overcooked_bench.kitchen.tracks.ring import find_middle, laps

EPISODES = 6
CONNECTED = ("cramped_room", "asymmetric_advantages", "coordination_ring", "counter_circuit")
WITH_HABITS = ("hesitant", "counter_passer", "clockwise", "anticlockwise", "waiter", "plates_first")


class Seen(NamedTuple):
    """What two agents did: points, cells, actions, deeds of each seat, and what was put down on which counter."""

    points: float
    x: np.ndarray  # (T + 1, episodes, 2)
    y: np.ndarray
    actions: np.ndarray  # (T, episodes, 2)
    taken: np.ndarray  # (T, episodes, 2)
    put: Counter  # (item, (x, y)) -> times


def watch(layout, *names):
    kitchens = Kitchens(layout, EPISODES, actions_taken=True, autoreset=False)
    kitchens.reset(4)
    width, agents = kitchens.layout.width, [SCRIPTED[name].factory(layout) for name in names]
    for seat, agent in enumerate(agents):
        agent.reset(layout, np.full(EPISODES, seat), np.arange(EPISODES, dtype=np.uint64))
    points, cells, actions, taken, put = 0.0, [kitchens.batch.position.astype(int)], [], [], Counter()
    for _ in range(kitchens.horizon):
        views, facing = kitchens.observe("lossless26"), kitchens.batch.facing.copy()
        actions.append(np.stack([agent.act(views[:, seat]) for seat, agent in enumerate(agents)], axis=1))
        result = kitchens.step(actions[-1])
        points += result.soup_reward.sum() / EPISODES
        taken.append(result.actions_taken)
        for row, seat in zip(*np.nonzero(taken[-1] & PUT_DOWN), strict=True):
            (dx, dy), cell = DIRECTIONS[facing[row, seat]], cells[-1][row, seat]
            put[int(item_of(taken[-1][row, seat])), (int(cell % width + dx), int(cell // width + dy))] += 1
        cells.append(kitchens.batch.position.astype(int))
    y, x = np.divmod(np.array(cells), width)
    return Seen(points, x, y, np.array(actions), np.array(taken), put)


@pytest.mark.parametrize(
    ("name", "onions", "dishes"),
    [
        *(("hesitant", 2, 3), ("counter_passer", 2, 1), ("clockwise", 1, 3)),
        *(("anticlockwise", 3, 1), ("waiter", 1, 2), ("plates_first", 3, 2)),
    ],
)
def test_objects_go_over_the_usual_counters(name, onions, dishes):
    seen = watch("forced_coordination", name, name)
    for item, row in ((ONION, onions), (DISH, dishes)):
        over = {y: sum(n for (what, cell), n in seen.put.items() if what == item and cell == (2, y)) for y in (1, 2, 3)}
        assert over[row] >= 0.8 * sum(over.values()) > 0, (item, over)


@pytest.mark.parametrize("layout", ["coordination_ring", "counter_circuit"])
def test_two_planners_walk_around_the_middle_their_way(layout):
    for name, way in (("clockwise", 0), ("anticlockwise", 1)):
        seen = watch(layout, name, name)
        middle = find_middle(Layout.load(layout))
        walked = sum(laps(seen.x[:, i], seen.y[:, i], middle).sum(axis=0) for i in range(EPISODES))
        assert walked[way] >= 4 * walked[1 - way]
        assert walked[way] >= 4 * EPISODES


def test_the_passer_takes_the_short_way_over_the_middle():
    middle = {(x, 2) for x in (2, 3, 4, 5)}
    passed = {
        name: sum(n for (item, cell), n in watch("counter_circuit", name, "greedy").put.items() if cell in middle)
        for name in ("counter_passer", "greedy")
    }
    assert passed["counter_passer"] >= 12 * EPISODES
    assert passed["greedy"] <= passed["counter_passer"] / 4


def test_the_waiter_plates_and_the_passer_leaves_it_to_the_partner():
    plates, pots = {}, {}
    for name in ("waiter", "counter_passer"):
        taken = watch("cramped_room", name, "greedy").taken
        plates[name], pots[name] = (np.mean(np.nonzero(taken & bit)[2] == 0) for bit in (PLATED, POTTED))
    assert plates["waiter"] > 0.65 > 0.35 > plates["counter_passer"]
    assert pots["waiter"] < 0.35 < 0.5 < pots["counter_passer"]


@pytest.mark.parametrize("layout", [*CONNECTED, "forced_coordination"])
def test_no_two_of_them_play_the_same(layout):
    played = {name: watch(layout, name, "greedy").actions.tobytes() for name in ("greedy", *WITH_HABITS)}
    assert len(set(played.values())) == len(played)


def test_the_waiter_plates_where_chefs_have_regions_of_their_own():
    plates = {
        name: np.nonzero(watch("asymmetric_advantages", name, "greedy").taken & PLATED)[2]
        for name in ("waiter", "greedy")
    }
    assert np.mean(plates["waiter"] == 0) > 0.6
    assert np.mean(plates["greedy"] == 0) < 0.55


def test_the_hesitant_one_does_nothing_in_every_third_step():
    waited = {
        name: np.mean(watch("coordination_ring", name, "greedy").actions[:, :, 0] == STAY)
        for name in ("hesitant", "greedy")
    }
    assert waited["hesitant"] - waited["greedy"] > 0.25


@pytest.mark.parametrize("name", WITH_HABITS)
@pytest.mark.parametrize("layout", [*CONNECTED, "forced_coordination", "coordination_ring-mirrored"])
def test_habits_do_not_stop_the_cooking(layout, name):
    assert watch(layout, name, name).points >= 80
    if layout in CONNECTED:
        assert watch(layout, name, "stay").points >= 20
        assert watch(layout, name, "random").points >= 20


@pytest.mark.parametrize("layout", CONNECTED)
def test_ways_with_a_preferred_turn_mirror_those_with_the_other(layout):
    plan, width = Layout.load(layout), Layout.load(layout).width
    mirrored = Layout.load(f"{layout}-mirrored")
    cells = np.arange(plan.height * width)
    turned = cells // width * width + width - 1 - cells % width
    ways, other = make_tables(plan, 1).ways, make_tables(mirrored, -1).ways
    np.testing.assert_array_equal(ways, other[np.ix_(turned, turned)])
    plain = make_tables(plan).ways
    assert (ways >= plain).all()
    assert (ways[plain < FAR] > plain[plain < FAR]).any()
