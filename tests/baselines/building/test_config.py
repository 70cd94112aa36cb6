from collections import Counter
from dataclasses import asdict

import pytest

from overcooked_bench.agents.pools.manifest import policies
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.baselines.building.config import PoolConfigError, load_pool_config, pool_config_names
from overcooked_bench.baselines.running.seeds import derive_seed
from tests.baselines.pools import OVERRIDES, group, pool_config, write_config


def test_every_run_follows_from_the_file(tmp_path):
    config = pool_config(
        tmp_path,
        group(count=11, by_layout={"cramped_room": {"steps": 640}}),
        group("half", count=2, first=11, keep=["half", "final"], snapshots=[0.8, 0.4]),
        layouts=["coordination_ring", "cramped_room"],
        cooking="manual",
    )
    runs = config.runs()
    assert len(runs) == 26
    assert [run.path for run in runs[:5]] == [
        *("coordination_ring/sp-0", "cramped_room/sp-0"),
        *("coordination_ring/half-0", "cramped_room/half-0", "coordination_ring/sp-1"),
    ]
    assert [run.name for run in runs[:3]] == ["sp-00", "sp-00", "half-0"]
    assert [runs[2].agent(kind) for kind in runs[2].group.keep] == ["half-0", "half-0-final"]
    assert [run.settings.steps for run in runs[:3]] == [320, 640, 320]
    assert runs[2].seed == derive_seed("tests of pools", "coordination_ring", "self-play", 11)
    assert runs[2].settings.snapshots == (0.4, 0.8)
    assert {run.settings.cooking for run in runs} == {"manual"}
    assert len({(run.layout, run.seed) for run in runs}) == len({run.lineage for run in runs}) == 26


@pytest.mark.parametrize(
    ("groups", "others", "message"),
    [
        ([group(count=0)], {}, "group sp: count is 0"),
        ([group(method="magic")], {}, "no training method named 'magic'"),
        ([group(config="fst")], {}, "did you mean 'fast'"),
        ([group(overrides={"step": 1})], {}, "did you mean 'steps'"),
        ([group(overrides={**OVERRIDES, "steps": 1})], {}, "steps=1; give at least two updates"),
        ([group(overrides={"cooking": "manual"})], {}, "cooking is no override"),
        ([group(keep=["half"])], {}, "give 1 shares at least"),
        ([group(keep=["half", "early"], snapshots=[0.5])], {}, "give 2 shares at least"),
        ([group(keep=["half"], snapshots=[0.0])], {}, "give one above 0 for half to be"),
        ([group(keep=["best"])], {}, "Invalid enum value 'best'"),
        ([group(keep=[])], {}, "each once"),
        ([group(keep=["clone"])], {}, "give clone to runs of human-proxy alone"),
        ([group(method="human-proxy", keep=["half"], snapshots=[0.5])], {}, "leave them out"),
        ([group(), group()], {}, "two groups have the prefix 'sp'"),
        ([group(count=3), group("more", first=2)], {}, "write first: 3 in more"),
        ([group(surprise=1)], {}, "unknown key `surprise`"),
        ([group()], {"layouts": ["cramped_rom"]}, "choose among .*cramped_room"),
        ([group()], {"layouts": []}, "choose among"),
        ([group(by_layout={"kitchen": {}})], {}, "choose among"),
        ([group()], {"groups": []}, "give one at least"),
        ([group()], {"cooking": "slow"}, "Invalid enum value 'slow'"),
        ([group(count={"cramped_room": -1})], {}, "no layout less than 0"),
        ([group(count={"cramped_rom": 2})], {}, "choose among .*cramped_room"),
        ([group(quota="x")], {}, "quotas has no 'x', which sp is a candidate for"),
        ([group()], {"quotas": {"x": 1}}, "quotas has no '', which sp is a candidate for; it has x"),
        ([group(quota="x")], {"quotas": {"x": 1, "y": 1}}, "quotas has y: 1"),
        ([group(quota="x")], {"quotas": {"x": 0}}, "quotas has x: 0"),
        ([group(quota="x")], {"quotas": {"x": 1}, "scripted": [{"name": "greedy"}]}, "'', which greedy is"),
        ([group(quota="x", keep=["final", "early"], snapshots=[0.5])], {"quotas": {"x": 1}}, "one kind to candidates"),
        (
            [group(quota="x")],
            {"quotas": {"x": 1}, "quotas_by_layout": {"cramped_room": {"y": 1}}},
            "quotas_by_layout, cramped_room, has y: 1; give a number from 0 for one of x",
        ),
        ([group(quota="x")], {"quotas": {"x": 1}, "quotas_by_layout": {"cramped_room": {"x": -1}}}, "has x: -1"),
        ([group(quota="x")], {"quotas": {"x": 1}, "quotas_by_layout": {"ring": {"x": 1}}}, "choose among .*cramped"),
        ([group()], {"extends": "train-v2"}, "did you mean 'train-v1'"),
        ([group()], {"extends": "v1-twin"}, "a configuration that extends no other one"),
    ],
    ids=[
        *(
            "count",
            "method",
            "config",
            "setting",
            "range",
            "override",
            "no-snapshots",
            "few-snapshots",
            "no-half",
            "kind",
            "nothing",
            "clone",
            "proxy-half",
        ),
        *("prefix", "seeds", "key", "layout", "no-layouts", "by-layout", "no-groups", "cooking"),
        *("negative", "count-layout", "no-quotas", "no-quota", "nobody", "no-number", "script", "kinds"),
        *("quota-elsewhere", "less-than-none", "quota-layout"),
        *("no-base", "twin-of-a-twin"),
    ],
)
def test_mistakes_are_told(tmp_path, groups, others, message):
    with pytest.raises(PoolConfigError, match=message):
        pool_config(tmp_path, *groups, **others)


def test_unknown_and_broken_files_are_told(tmp_path):
    with pytest.raises(PoolConfigError, match="did you mean 'dev-v1'"):
        load_pool_config("dev-v2")
    file = write_config(tmp_path)
    for content, message in ((b"{", "not YAML"), (b"\xff", "UTF-8"), (b"[]", "not a mapping")):
        file.write_bytes(content)
        with pytest.raises(PoolConfigError, match=message):
            load_pool_config(file)


def test_no_two_shipped_configurations_share_a_seed():
    seeds = {}
    for name in pool_config_names():
        config = load_pool_config(name)
        assert config.name == name
        for run in config.runs():
            assert seeds.setdefault((run.layout, run.seed), run.lineage) == run.lineage
    assert len({lineage.partition("/")[0] for lineage in seeds.values()}) == len(pool_config_names())


def test_the_pools_are_as_large_as_they_should_be():
    sizes = {
        name: {
            layout: len([r for r in load_pool_config(name).runs() if r.layout == layout])
            for layout in ("cramped_room", "counter_circuit")
        }
        for name in pool_config_names()
    }
    assert sizes["dev-v1"] == {"cramped_room": 10, "counter_circuit": 10}
    assert sizes["train-v1"] == {"cramped_room": 16, "counter_circuit": 16}


def test_v1_has_partners_of_four_origins_and_twice_the_candidates_where_conventions_matter():
    config = load_pool_config("v1")
    strata = {group.quota: group.stratum for group in config.groups} | {"scripted": "scripted"}
    for layout in config.layouts:
        wanted, trained = Counter(), Counter()
        for quota, number in config.quotas_on(layout).items():
            wanted[strata[quota]] += number
        for run in config.runs():
            trained[run.group.stratum] += run.layout == layout
        assert wanted == {"own": 12, "other-trainers": 8, "human": 6, "scripted": 6}
        assert trained.total() >= (1 if layout in ("cramped_room", "asymmetric_advantages") else 2) * 26


def test_a_twin_has_the_recipe_and_none_of_the_seeds():
    original, twin, other = load_pool_config("v1"), *(load_pool_config("v1-twin", salt) for salt in ("a", "b"))
    assert (twin.name, twin.namespace, twin.trained) == ("v1-twin", "v1-twin/a", "v1-twin-candidates")
    assert (twin.quotas, twin.quotas_by_layout) == (original.quotas, original.quotas_by_layout)
    runs = [config.runs() for config in (original, twin, other)]
    for ours, theirs in zip(*runs[:2], strict=True):
        assert (ours.path, ours.settings, ours.group) == (theirs.path, theirs.settings, theirs.group)
    seeds = [{(run.layout, run.seed) for run in some} for some in runs]
    assert len(seeds[0] | seeds[1] | seeds[2]) == 3 * len(runs[0])
    with pytest.raises(PoolConfigError, match="the salt is 'a/b'"):
        load_pool_config("v1-twin", "a/b")


def test_the_first_pool_was_trained_with_what_its_configuration_says():
    pool = Pool.load("dev-v0")
    runs = load_pool_config("dev-v0").runs()
    assert len(runs) == len(policies(pool.manifest))
    for run in runs:
        entry, settings = pool.agent(run.layout, run.name), asdict(run.settings)
        agent = entry.trained
        assert (agent.seed, entry.lineage, agent.method) == (run.seed, run.lineage, run.group.method)
        update = settings["num_kitchens"] * settings["rollout"]
        assert run.settings.steps <= agent.steps < run.settings.steps + update
        for key, value in agent.settings.items():
            assert settings[key] == (tuple(value) if isinstance(value, list) else value), key
