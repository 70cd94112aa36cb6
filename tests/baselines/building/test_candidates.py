import msgspec
import pytest

from overcooked_bench.agents.pools.records import SelfPlay
from overcooked_bench.baselines.building.build import PoolBuildError
from overcooked_bench.baselines.building.candidates import candidates, fit, needed
from tests.agents.made import record
from tests.baselines.pools import group, pool_config

LAYOUT = "cramped_room"
RING = "coordination_ring"


def config_of_two(folder, **others):
    """Two groups that are candidates for one quota of three, and one that is alone in another one."""
    return pool_config(
        folder,
        group("a", quota="many", count={RING: 2}),
        group("b", quota="many", first=10),
        group("c", quota="one", first=12, stratum="own"),
        **{"layouts": [LAYOUT, RING], "quotas": {"many": 3, "one": 1}, **others},
    )


def points(name, layout, mean, **others):
    return record(name, layout, self_play=SelfPlay(mean=mean, low=mean, high=mean, episodes=100), **others)


def finish(held, runs, mean=200.0):
    """Adds the agents of some runs to the candidates that are trained."""
    held |= {(run.layout, run.name): points(run.name, run.layout, mean) for run in runs}
    return [run.path for run in runs]


def test_further_seeds_of_a_quotas_groups_are_trained_in_turn_until_it_can_be_met(tmp_path):
    config, held = config_of_two(tmp_path), {}
    counted = finish(held, needed(config, held))
    assert sorted(counted) == sorted(run.path for run in config.runs())
    assert finish(held, needed(config, held), mean=39.9) == [f"{LAYOUT}/a-1"]  # two of three
    assert finish(held, needed(config, held)) == [f"{LAYOUT}/b-1"]
    assert needed(config, held) == []
    names = [entry.name for entry in candidates(config, "many", LAYOUT, held)]
    assert names == ["a-0", "b-0", "b-1"]
    assert finish(held, needed(config, held, out={(LAYOUT, "b-0"), (RING, "c-0")})) == [f"{LAYOUT}/a-2", f"{RING}/c-1"]
    assert {run.seed for run in config.further(LAYOUT, "many")}.isdisjoint(run.seed for run in config.runs())


def test_a_quota_may_be_another_one_on_a_layout(tmp_path):
    config, held = config_of_two(tmp_path, quotas_by_layout={LAYOUT: {"many": 4, "one": 0}, RING: {"many": 2}}), {}
    assert config.quotas_on(RING) == {"many": 2, "one": 1}
    finish(held, config.runs())
    assert finish(held, needed(config, held)) == [f"{LAYOUT}/a-1"]  # three of four
    assert finish(held, needed(config, held, out={(LAYOUT, "c-0"), (RING, "b-0")})) == [f"{LAYOUT}/b-1"]
    assert needed(config, held, out={(LAYOUT, "c-0"), (RING, "b-0")}) == []


def test_a_quota_that_no_further_seed_can_meet_is_an_error(tmp_path):
    config, held = config_of_two(tmp_path), {}
    assert {run.name for run in config.further(LAYOUT, "many") if run.group.prefix == "b"} == {"b-1"}, "c begins there"
    finish(held, config.runs())
    finish(held, [run for run in config.further(LAYOUT, "many")], mean=0.0)
    with pytest.raises(PoolBuildError, match="cramped_room: 2 candidates are fit for the quota 'many', which is 3"):
        needed(config, held)


def test_unfinished_runs_come_before_further_ones(tmp_path):
    config, held = config_of_two(tmp_path), {}
    finish(held, [run for run in config.runs() if run.group.prefix == "a"])
    left = [run.path for run in needed(config, held)]
    assert left == [f"{LAYOUT}/b-0", f"{RING}/b-0", f"{LAYOUT}/c-0", f"{RING}/c-0"]


def test_a_group_without_runs_on_a_layout_has_no_further_ones_there(tmp_path):
    config = pool_config(
        tmp_path,
        group("a", quota="q", count={LAYOUT: 0}),
        group("b", quota="q", first=20),
        **{"layouts": [LAYOUT, RING], "quotas": {"q": 1}},
    )
    assert {run.group.prefix for run in config.further(LAYOUT, "q")} == {"b"}
    assert [run.path for run in config.runs()] == [f"{RING}/a-0", f"{LAYOUT}/b-0", f"{RING}/b-0"]


def test_who_is_not_meant_to_cook_well_alone_may_be_weak_with_itself():
    assert not fit(points("final", LAYOUT, 39.0))
    assert fit(points("final", LAYOUT, 40.0))
    assert fit(points("half", LAYOUT, 0.0, checkpoint=0.5))
    assert fit(points("clone", LAYOUT, 0.0, method="human-proxy"))
    assert fit(msgspec.structs.replace(points("script", LAYOUT, 0.0), training=None))
