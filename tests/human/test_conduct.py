"""What chefs do is counted as a person would count it, for people's games and agents' games."""

import msgspec
import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as some

from overcooked_bench import KitchenState
from overcooked_bench.errors import WrongUse
from overcooked_bench.estimate import t_interval
from overcooked_bench.human.conduct import conduct, conducts
from overcooked_bench.human.distances import hand_over_distance, visit_distance
from overcooked_bench.human.game import Game
from overcooked_bench.human.games import record
from overcooked_bench.human.tracks import follow
from overcooked_bench.kitchen.codes import ACTION_LETTERS, PICKED_UP, PUT_DOWN
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import Chef
from overcooked_bench.kitchen.tracks.counts import count
from tests.human.made import PEOPLE, agents_games, random_game
from tests.kitchen.strategies import law

LAYOUTS = ("cramped_room", "coordination_ring", "forced_coordination", "counter_circuit-mirrored")
GREEDY = {layout: agents_games(layout, horizon=60)[0] for layout in LAYOUTS}


def played(layout: str, first: str, second: str, **more) -> Game:
    actions = np.array([[ACTION_LETTERS.index(letter) for letter in letters] for letters in (first, second)]).T
    return record(layout, actions, seats=PEOPLE, source="made up", **more)


def test_a_hand_over_is_put_down_by_one_chef_and_picked_up_by_the_other():
    found = conduct([played("forced_coordination", "DLSSISSS", "LIRISSSS")])
    assert found.handovers == {((2, 2), "onion"): 1.0}
    assert (found.hand_overs.value, found.chefs[0].hands_over, found.chefs[1].hands_over) == (50, 0, 50)
    assert found.handed[0].rates == (0, 50)
    assert (found.chefs[1].events["ingredients"], found.chefs[1].events["counter_drops"]) == (50, 50)
    assert (found.chefs[0].events["counter_pickups"], found.chefs[0].events["ingredients"]) == (50, 0)


def test_within_one_step_chef_0_hands_over_first():
    found = conduct([played("forced_coordination", "DLSSIISS", "LIRISISS")])
    assert found.handed[0].rates == (50, 50)


def test_what_a_chef_picks_up_again_is_not_handed_over():
    assert conduct([played("forced_coordination", "DLSSSSI", "LIRIISS")]).handed == ()


def test_what_is_there_at_the_start_is_not_handed_over():
    start = KitchenState((Chef((3, 2), "west"), Chef((1, 2))), {(2, 2): "dish"})
    found = conduct([played("forced_coordination", "I", "S", start=start)])
    assert found.chefs[0].events["counter_pickups"] == 400
    assert found.handed == ()


def test_a_chef_is_stuck_where_it_neither_moves_nor_turns():
    found = conduct([played("cramped_room", "RRRSSS", "DSSRRS")])
    assert [chef.blocked for chef in found.chefs] == [2 / 6, 0]  # chef 1 stands in the way of chef 0
    assert [chef.stuck for chef in found.chefs] == [2 / 6, 1 / 6]  # chef 1 turns to the counter, then it is stuck
    assert (found.blocked.value, found.stuck.value) == (2 / 12, 3 / 12)
    assert [chef.idle for chef in found.chefs] == [3 / 6, 3 / 6]


@pytest.mark.parametrize(("layout", "clockwise"), [("coordination_ring", 1.0), ("coordination_ring-mirrored", 0.0)])
def test_a_lap_has_a_direction(layout, clockwise):
    turned = str.maketrans("LR", "RL") if "mirrored" in layout else {}
    letters = (text.translate(turned) for text in ("RDDLLUUR", "URRDDLLU"))
    found = conduct([played(layout, *letters)])
    assert found.clockwise.value == clockwise
    laps = (50, 0) if clockwise else (0, 50)
    for chef in found.chefs:
        assert (chef.laps, chef.clockwise) == (pytest.approx(laps), clockwise)
        assert np.array(chef.visits).max() == 1 / 8


def test_to_and_fro_is_no_direction():
    found = conduct([played("coordination_ring", "RDUL" + "S" * 4, "D" + "S" * 7)])
    assert found.chefs[0].clockwise is None
    assert found.chefs[0].laps == (0, 0)
    assert found.chefs[1].clockwise == 0


def test_a_kitchen_without_a_ring_has_no_direction():
    found = conduct([random_game("cramped_room")])
    assert (found.clockwise, found.chefs[0].laps) == (None, None)


@law
@given(some.sampled_from(LAYOUTS), some.integers(0, 99), some.integers(1, 60))
def test_shares_sum_to_one(layout, seed, steps):
    found = conduct([random_game(layout, steps, seed), GREEDY[layout]])
    assert sum(found.actions) == pytest.approx(1)
    assert found.visits.sum(axis=(1, 2)) == pytest.approx(1)
    assert sum(found.handovers.values()) == pytest.approx(1) or not found.handed
    assert found.idle.value == pytest.approx(np.mean([chef.idle for chef in found.chefs]))
    assert found.hand_overs.value == pytest.approx(sum(chef.hands_over for chef in found.chefs))
    assert found.soups.value == pytest.approx(sum(chef.events["deliveries"] for chef in found.chefs))
    assert found.points.value == pytest.approx(20 * found.soups.value)
    assert visit_distance(found, found) == hand_over_distance(found, found) == 0
    assert msgspec.json.decode(msgspec.json.encode(found), type=type(found)) == found


@law
@given(some.sampled_from(LAYOUTS), some.integers(0, 99), some.integers(1, 60))
def test_swapping_the_chefs_swaps_what_they_do(layout, seed, steps):
    (track,) = follow([random_game(layout, steps, seed)])
    assume(not (track.taken & (PUT_DOWN | PICKED_UP) != 0).all(axis=1).any())  # chef 0 goes first
    swapped = track._replace(
        **{name: getattr(track, name)[:, ::-1] for name in ("cells", "facing", "actions", "taken")},
        points=track.points[::-1],
    )
    here, there = (count(Layout.load(layout), one) for one in (track, swapped))
    for name in ("points", "actions", "deeds", "stuck", "blocked", "laps", "visits"):
        assert getattr(here, name).tolist() == getattr(there, name)[::-1].tolist()
    assert here.handed == {(cell, item, 1 - giver): n for (cell, item, giver), n in there.handed.items()}


@law
@given(some.sampled_from(LAYOUTS), some.integers(0, 99), some.integers(1, 60))
def test_games_together_are_the_mean_weighted_by_steps(layout, seed, steps):
    games = random_game(layout, steps, seed), GREEDY[layout]
    one, other, both = conduct(games[:1]), conduct(games[1:]), conduct(games)
    weights = [steps / (steps + 60), 60 / (steps + 60)]

    def mean(value):
        return pytest.approx(np.average([value(one), value(other)], axis=0, weights=weights))

    for value in (
        lambda found: [found.soups.value, found.idle.value, found.stuck.value, found.hand_overs.value],
        lambda found: found.actions,
        lambda found: found.visits,
        lambda found: [list(chef.events.values()) for chef in found.chefs],
    ):
        assert np.array(value(both)) == mean(value)
    assert (both.games, both.steps) == (2, steps + 60)
    together = [
        mean(lambda found, key=key: found.handovers.get(key, 0) * found.hand_overs.value) for key in both.handovers
    ]
    assert [share * both.hand_overs.value for share in both.handovers.values()] == together


def test_intervals_are_over_pairs_of_people():
    games = agents_games(number=6, horizon=80, groups=("a", "b", "c"), start="random")
    found = conduct(games)
    assert found.pairs == 3
    means = [conduct([game for game in games if game.group == name]).soups.value for name in "abc"]
    assert tuple(found.soups) == pytest.approx(tuple(t_interval(means, lowest=0)))
    assert found.soups.interval is not None
    assert conduct(games[:1]).soups.interval is None
    mixed = conduct([*games, *agents_games(horizon=80)])
    assert (mixed.pairs, mixed.soups.interval) == (0, None)


def test_a_distance_is_a_total_variation():
    first = conduct([played("forced_coordination", "DLSSISSS", "LIRISSSS")])
    other = conduct([played("forced_coordination", "LSSSSSI", "ULIRISS")])
    assert other.handovers == {((2, 1), "onion"): 1.0}
    assert hand_over_distance(first, other) == 1
    half = conduct(
        [played("forced_coordination", "DLSSISSS", "LIRISSSS"), played("forced_coordination", "LSSSSSI", "ULIRISS")]
    )
    assert hand_over_distance(first, half) == hand_over_distance(half, first) == 0.5
    still = conduct([played("forced_coordination", "S", "S")])
    assert hand_over_distance(first, still) == 1
    assert hand_over_distance(still, still) == 0
    assert visit_distance(still, first) == pytest.approx(np.mean([7 / 8, 0]))


def test_layouts_are_described_one_by_one():
    games = [random_game("counter_circuit"), random_game("XPOX\nX  D\nXXSX"), random_game("cramped_room")]
    found = conducts(games)
    assert [one.layout for one in found] == ["cramped_room", "counter_circuit", "XPOX\nX  D\nXXSX"]
    assert conducts([]) == []
    with pytest.raises(WrongUse, match="give games of one layout"):
        conduct(games)
    with pytest.raises(WrongUse, match="conduct of no games"):
        conduct([])
    for distance in (hand_over_distance, visit_distance):
        with pytest.raises(WrongUse, match="cannot be compared"):
            distance(found[0], found[1])


def test_many_games_are_counted_as_few_are(monkeypatch):
    games = [random_game("cramped_room", 5 + seed, seed) for seed in range(5)]
    found = conduct(games)
    monkeypatch.setattr("overcooked_bench.human.tracks._MOST_GAMES", 2)
    assert conduct(games) == found
