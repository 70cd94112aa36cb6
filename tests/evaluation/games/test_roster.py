"""Who is played on a layout, and that every kind of partner plays."""

import msgspec
import pytest

from overcooked_bench.agents.behaviours.parsing import VERSION
from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import BehaviourReference
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.games.roster import check_pool, roster
from overcooked_bench.evaluation.protocol import ProtocolError
from overcooked_bench.rendering.replay import frames_of
from tests.agents.made import record, scripted, write_policy
from tests.evaluation.made import block


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
