import pytest

from overcooked_bench.agents.pools.lineage import at_home, check_lineages
from overcooked_bench.agents.pools.manifest import read_manifest, write_manifest
from overcooked_bench.agents.pools.pool import find_pool, shipped_pools
from tests.agents.made import record, scripted, write_policy

LAYOUT = "cramped_room"


def manifest(home, name, *records, first=0):
    for seed, entry in enumerate(records, start=first):
        write_policy(home / name / entry.layout / entry.name, seed)
    return write_manifest(home / name, name, records)


def grave(findings):
    assert all(finding.grave for finding in findings)
    return [finding.text for finding in findings]


RUN = {"lineage": "run", "seed": 1}


def test_independent_agents_and_checkpoints_of_a_run_are_fine(tmp_path):
    pool = manifest(tmp_path, "a", record("sp-0", **RUN), record("sp-0-half", checkpoint=0.5, **RUN), record("sp-1"))
    assert check_lineages(pool) == []


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (RUN, "sp-0, sp-1 are the same checkpoint, 1.0"),
        (RUN | {"checkpoint": 0.5, "settings": {}}, "they differ in settings"),
        (RUN | {"checkpoint": 0.5, "method": "other"}, "they differ in method"),
        (RUN | {"checkpoint": 0.5, "configuration": "other"}, "they differ in configuration"),
        (RUN | {"checkpoint": 0.5, "seed": 2}, "they differ in seed"),
        ({"lineage": "other", "seed": 1}, "sp-0, sp-1 have the training seed 1 and different lineages"),
    ],
    ids=["twice", "training", "method", "configuration", "seed", "lineage"],
)
def test_hidden_ties_are_found(tmp_path, other, message):
    (text,) = grave(check_lineages(manifest(tmp_path, "a", record("sp-0", **RUN), record("sp-1", **other))))
    assert message in text


def test_a_seed_may_be_used_again_on_another_layout(tmp_path):
    write_policy(tmp_path / "coordination_ring" / "sp-0", 9, layout="coordination_ring", shape=(22, 5, 5))
    write_policy(tmp_path / "cramped_room" / "sp-0", 1)
    records = [record("sp-0", seed=1), record("sp-0", "coordination_ring", seed=1)]
    assert check_lineages(write_manifest(tmp_path, "a", records)) == []


def test_format_1_knows_no_checkpoints(tmp_path):
    shipped = read_manifest_of("dev-v0")
    assert check_lineages(shipped) == []
    import msgspec

    tied = [msgspec.structs.replace(agent, lineage="one") for agent in shipped.entries[:2]]
    (text,) = grave(check_lineages(msgspec.structs.replace(shipped, entries=tuple(tied))))
    assert "do not say which checkpoints" in text


def read_manifest_of(name):
    return read_manifest(find_pool(name))


def test_pools_share_nothing(tmp_path):
    ours = manifest(tmp_path, "a", record("sp-0", seed=1, lineage="x"), record("sp-1", seed=2, lineage="y"))
    apart = manifest(tmp_path, "b", record("sp-0", seed=3, lineage="z", namespace="b"), first=5)
    assert check_lineages(ours, [apart]) == []
    tied = manifest(tmp_path, "c", record("sp-0", seed=1, lineage="y"))
    found = check_lineages(ours, [apart, tied])
    assert [finding.text for finding in found] == [
        "cramped_room/sp-0 shares the training seed with c/cramped_room/sp-0",
        "cramped_room/sp-1 shares the lineage with c/cramped_room/sp-0",
        "cramped_room/sp-0 shares the weights with c/cramped_room/sp-0",
        "the seed namespace 'tests' is also used by the pool c",
    ]
    assert [finding.grave for finding in found] == [True, True, True, False]


def test_a_person_of_set_b_is_behind_the_agents_of_one_pool_alone(tmp_path):
    ours = manifest(tmp_path, "a", record("sp-0", seed=1, people=("2019-00", "2019-03")), record("sp-1", seed=2))
    own = {"seed": 3, "lineage": "z", "namespace": "b"}
    apart = manifest(tmp_path, "b", record("sp-0", people=("2019-01",), **own), first=5)
    tied = manifest(tmp_path, "c", record("sp-0", people=("2019-00", "2019-03", "2019-05"), **own), first=7)
    assert check_lineages(ours, [apart]) == []
    tie, same = check_lineages(ours, [apart, tied])
    assert tie.grave
    assert tie.text.startswith("agents such as cramped_room/sp-0 were made from games of 2019-03,")
    assert "those of the pool c too" in tie.text
    assert not same.grave, "set A may be in several pools"
    assert "made from games of 2019-00," in same.text


@pytest.mark.parametrize("weights", [(0.5, 0.5), (None, None)])
def test_a_lineage_has_one_partner_in_a_pool_with_weights(tmp_path, weights):
    run = [{"weight": weight, **RUN} for weight in weights]
    pool = manifest(tmp_path, "a", record("sp-0", **run[0]), record("half", checkpoint=0.5, **run[1]), record("sp-1"))
    texts = grave(check_lineages(pool))
    assert [text.partition(";")[0] for text in texts] == [
        f"{LAYOUT}: half, sp-0 are of one lineage, 'run'" for weight in weights[:1] if weight
    ]


def test_an_agent_is_at_home_with_its_code_and_its_people():
    ours, theirs = record(), record(codebase="jaxmarl")
    clone = record(method="human-proxy", people=("2019-00", "2019-02"))
    taught = record(people=("2019-02",))
    script = scripted("greedy")
    partners = ours, theirs, clone, taught, script
    home = lambda codebase, people=(): [at_home(codebase, people, partner) for partner in partners]  # noqa: E731
    assert home(None) == [True, False, False, True, False]
    assert home("jaxmarl") == [False, True, False, False, False]
    assert home(None, ("2019-00",)) == [True, False, True, True, False]
    assert home("", ("2019-02", "2019-01")) == [False, False, True, True, False]
    assert home("elsewhere") == home("") == [False] * 5


def test_the_shipped_pools_share_no_run_and_no_person_who_only_tests():
    shipped = [read_manifest_of(name) for name in shipped_pools()]
    for pool in shipped:
        found = check_lineages(pool, [other for other in shipped if other.name != pool.name])
        assert not [finding.text for finding in found if finding.grave]
