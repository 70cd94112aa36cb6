"""Who is played on a layout, and that every kind of partner plays."""

import msgspec
import pytest

from overcooked_bench.agents.behaviours.parsing import VERSION
from overcooked_bench.agents.pools.manifest import PoolError, write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import BehaviourReference, Bound
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.games.roster import check_pool, roster
from overcooked_bench.evaluation.protocol import ProtocolError
from overcooked_bench.rendering.replay import frames_of
from tests.agents.made import record, scripted, write_policy
from tests.evaluation.made import block, changed, reporting, score


@pytest.fixture
def pool(tmp_path):
    """A policy, a scripted partner, a floor and a behaviour that names a cell."""
    home = BehaviourReference(behaviour={"does": "goto", "cell": [1, 1]}, version=VERSION)
    write_policy(tmp_path / "pool" / "cramped_room" / "sp-0", 0)
    entries = [record("sp-0"), scripted("greedy"), scripted("random", role="floor")]
    entries.append(msgspec.structs.replace(scripted("homing"), reference=home))
    write_manifest(tmp_path / "pool", "every", entries)
    return tmp_path / "pool"


def test_a_pool_lists_everybody_who_is_played(pool):
    found = [(partner.name, partner.kind) for partner in roster(Pool.load(pool), "cramped_room")]
    assert found == [("greedy", "scripted"), ("homing", "scripted"), ("random", "floor"), ("sp-0", "trained")]
    assert roster(Pool.load(pool), "cramped_room-mirrored") == roster(Pool.load(pool), "cramped_room")
    assert roster(Pool.load(pool), "counter_circuit") == ()


@pytest.mark.parametrize(("layout", "cell"), [("cramped_room", (1, 1)), ("cramped_room-mirrored", (3, 1))])
def test_every_kind_plays_in_a_mirrored_kitchen_too(protocol, pool, layout, cell):
    outcome = play_block(block(protocol, "stay", layout=layout, pool=pool))
    assert len(outcome.episodes) == 8
    for episode in outcome.episodes:
        if episode.partner == "homing" and episode.first_state.chefs[episode.seat].position != cell:
            *_, (last, _) = frames_of(layout, episode.first_state, episode.joint_actions(40), horizon=40)
            assert last.chefs[1 - episode.seat].position == cell


def test_a_few_partners_are_those_of_greatest_weight_in_each_stratum(tmp_path):
    weights = {"clockwise": 0.1, "greedy": 0.6, "waiter": 0.3}
    entries = [msgspec.structs.replace(scripted(name), weight=weight) for name, weight in weights.items()]
    entries += [msgspec.structs.replace(scripted("onion_courier"), stratum="human"), scripted("stay", role="floor")]
    write_manifest(tmp_path, "weighed", entries)
    pool = Pool.load(tmp_path)
    names = [[partner.name for partner in roster(pool, "cramped_room", few)] for few in (1, 2, 9)]
    assert names[:2] == [["greedy", "onion_courier"], ["greedy", "onion_courier", "waiter"]]
    assert names[2] == [*sorted([*weights, "onion_courier"])]


def test_floors_alone_are_no_pool(protocol, tmp_path):
    write_manifest(tmp_path, "idle", [scripted("stay", role="floor")])
    with pytest.raises(ProtocolError, match="the pool 'idle' has no partners for cramped_room"):
        check_pool(Pool.load(tmp_path), protocol, ["cramped_room"])


KNOWN = dict(floor_agent="stay", low=90, high=110, episodes=9, responder="greedy", responder_sha256="0" * 64)


def bound(ceiling=90, side=0):
    return Bound(side=side, floor=10, ceiling=ceiling, **KNOWN)


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ([{"weight": 0.5}, {}], "'bad' on cramped_room: 1 of 2 partners of the stratum 'scripted' have a weight"),
        ([{"bounds": (bound(side=1),)}, {}], "'bad' on cramped_room: greedy has no floor and ceiling for side 0"),
        ([{}, {"bounds": (bound(ceiling=10),)}], "'bad' on cramped_room: stay, side 0: the ceiling of 10 points is"),
    ],
    ids=["weights", "sides", "ceiling"],
)
def test_what_cannot_be_scored_is_refused_before_it_is_played(changes, said, protocol, tmp_path):
    entries = [
        msgspec.structs.replace(scripted(name), **change)
        for name, change in zip(("greedy", "stay"), changes, strict=True)
    ]
    write_manifest(tmp_path, "bad", entries)
    pool = Pool.load(tmp_path)
    with pytest.raises(PoolError, match=said):
        check_pool(pool, protocol, ["cramped_room"])
    if "weight" not in said:
        check_pool(pool, reporting(protocol, metrics=("mean",)), ["cramped_room"])


@pytest.mark.parametrize(("start", "seats", "needed"), [("random", (0,), {0, 1}), ("standard", (0,), {1})])
def test_bounds_are_needed_for_the_sides_that_the_agent_can_start_on(start, seats, needed, protocol, tmp_path):
    layout = "forced_coordination"
    rules = changed(protocol, layouts=(layout,), start=start, seats=seats)
    for sides in ((0,), (1,), (0, 1)):
        bounds = tuple(bound(side=side) for side in sides)
        write_manifest(tmp_path, "sides", [msgspec.structs.replace(scripted("greedy", layout), bounds=bounds)])
        if needed <= set(sides):
            check_pool(Pool.load(tmp_path), rules, [layout])
        else:
            with pytest.raises(PoolError, match="no floor and ceiling for side"):
                check_pool(Pool.load(tmp_path), rules, [layout])


def test_a_partner_of_weight_0_does_not_count_and_costs_no_score(protocol, tmp_path):
    entries = [msgspec.structs.replace(scripted("greedy"), weight=1.0, bounds=(bound(),))]
    entries += [msgspec.structs.replace(scripted("stay"), weight=0.0, bounds=(bound(),))]
    write_manifest(tmp_path / "pool", "light", entries)
    rules = changed(protocol, horizon=100)
    scores = score("greedy", rules, pool=tmp_path / "pool", output=tmp_path / "out").scores
    alone = [scores.find("n", layout="cramped_room", partner=name).value for name in ("greedy", "stay")]
    assert scores.find("n", layout="cramped_room").value == alone[0] != alone[1]
