import pytest

from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.pools import pairs
from overcooked_bench.evaluation.pools.meeting import meet, play_pairs
from overcooked_bench.evaluation.pools.players import Player, players_of
from tests.agents.made import record, scripted, write_policy

LAYOUT = "forced_coordination"
SHAPES = {"shape": (22, 5, 5), "layout": LAYOUT}


def write_pool(home, kinds, cooking="auto"):
    entries = []
    for seed, (name, settings) in enumerate(kinds.items()):
        write_policy(home / LAYOUT / name, 10 * len(home.name) + seed, **(SHAPES | settings), cooking=cooking)
        entries.append(record(name, LAYOUT))
    write_manifest(home, home.name, [*entries, scripted("greedy", LAYOUT)], cooking=cooking)
    return Pool.load(home)


@pytest.fixture(scope="module")
def players(tmp_path_factory):
    """Those of two pools: three policies of two architectures, and `greedy` twice."""
    home = tmp_path_factory.mktemp("pools")
    stacked = {"hidden": (4,), "observation": "stack_channels", "shape": (52, 5, 5)}
    first = write_pool(home / "one", {"sp-0": {}, "wide-0": stacked})
    second = write_pool(home / "other", {"sp-0": {}})
    return {player.reference: player for pool in (first, second) for player in players_of(pool, LAYOUT)}


def test_players_of_a_pool_are_its_partners(players):
    assert list(players)[:3] == [f"one/{LAYOUT}/{name}" for name in ("greedy", "sp-0", "wide-0")]
    assert len({player.sha256 for player in players.values()}) == len(players) - 1  # greedy is greedy


def test_agents_and_partners_of_several_pools_meet_from_both_seats_and_both_sides(players):
    known = Pool.load("dev-v0")
    sp = [player for player in players_of(known, LAYOUT) if player.entry.name in ("sp-0", "sp-2")]
    found = meet(LAYOUT, [*sp, players[f"one/{LAYOUT}/sp-0"]], [*sp, Player.scripted("stay", LAYOUT)], episodes=4)
    assert found.returns.shape == found.sides.shape == (3, 3, 4, 2)
    assert found.agents[0] == f"dev-v0/{LAYOUT}/sp-0"
    assert found.partners[2] == "stay"
    for i in range(2):
        assert found.means[i, i] == pytest.approx(sp[i].entry.trained.self_play.mean, abs=15)
    assert (found.means[:2, :2].diagonal() > 3 * found.means[[0, 1], [1, 0]]).all()  # conventions of their own
    assert (found.means[2] < 5).all()
    assert (found.means[:, 2] < 5).all()
    assert (found.sides.sum(axis=3) == 1).all()  # one seat is on one side, the other one on the other
    assert (found.sides == found.sides[:1]).all()  # all agents meet a partner from the same starts


def test_results_do_not_depend_on_how_pairs_are_cut_or_on_workers(players, monkeypatch):
    everybody = list(players.values())
    told = []
    whole = meet(LAYOUT, everybody, everybody[:3], 2, horizon=60, on_progress=lambda *at: told.append(at))
    assert told == [(15, 15)]
    monkeypatch.setattr(pairs, "MOST_ROWS", 8)
    told.clear()
    parts = meet(LAYOUT, everybody, everybody[:3], 2, horizon=60, workers=2, on_progress=lambda *at: told.append(at))
    assert len(told) == 9
    assert told[-1] == (15, 15)
    assert (whole.returns == parts.returns).all()
    assert (whole.sides == parts.sides).all()
    assert whole.returns.any()


@pytest.mark.slow
def test_a_cluster_plays_the_same(players, monkeypatch):
    everybody, some = list(players.values()), [(0, 1), (3, 1), (2, 2)]
    here = play_pairs(LAYOUT, everybody, some, 2, horizon=60)
    monkeypatch.setattr(pairs, "MOST_ROWS", 8)
    there = play_pairs(LAYOUT, everybody, some, 2, horizon=60, workers=2, engine="dask")
    assert (here.returns == there.returns).all()
    assert (here.sides == there.sides).all()


def test_a_seed_and_a_purpose_play_other_games():
    greedy = [Player.scripted("greedy", LAYOUT)]
    said = [{}, {}, {"seed": 1}, {"purpose": "something else"}]
    first, again, other, apart = (meet(LAYOUT, greedy, greedy, 8, horizon=200, **how).sides for how in said)
    assert (first == again).all()
    assert (first != other).any()
    assert (first != apart).any()


def test_some_pairs_are_played_as_all_of_them(players):
    everybody = list(players.values())
    whole = meet(LAYOUT, everybody, everybody, 1, horizon=60)
    some = play_pairs(LAYOUT, everybody, [(4, 1), (0, 3), (2, 2)], 1, horizon=60)
    assert (some.returns == whole.returns[[4, 0, 2], [1, 3, 2]]).all()


@pytest.mark.parametrize(
    ("partners", "most", "ends"),
    [
        ([0, 0, 0, 1, 1, 1], 6, [6]),
        ([0, 0, 0, 1, 1, 1], 5, [3, 6]),
        ([0, 0, 0, 1, 1, 1], 2, [2, 3, 5, 6]),
        ([0, 1, 1, 2], 2, [1, 3, 4]),
    ],
)
def test_a_block_has_all_pairs_of_a_partner_if_they_fit(partners, most, ends):
    assert pairs._ends(partners, most) == ends


def test_players_that_do_not_fit_are_refused(players, tmp_path):
    one = players[f"one/{LAYOUT}/sp-0"]
    with pytest.raises(WrongUse, match="greedy plays 'cramped_room'; give players of 'forced_coordination'"):
        meet(LAYOUT, [one], [Player.scripted("greedy", "cramped_room")], 1)
    by_hand = write_pool(tmp_path / "by-hand", {"sp-0": {}}, cooking="manual")
    with pytest.raises(WrongUse, match="differ in their cooking mode"):
        meet(LAYOUT, [one], players_of(by_hand, LAYOUT), 1)
    with pytest.raises(WrongUse, match="give one of each at least"):
        meet(LAYOUT, [one], [], 1)
