import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import msgspec
import pytest

from overcooked_bench.agents.behaviours.parsing import VERSION
from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.policies.policy import PolicyError
from overcooked_bench.agents.pools.manifest import PoolError, check_version, people_of, read_manifest, write_manifest
from overcooked_bench.agents.pools.pool import Pool, find_pool, shipped_pools
from overcooked_bench.agents.pools.records import BehaviourReference, Bound, ScriptedReference
from tests.agents.made import record, scripted, write_policy

GOLDEN = Path(__file__).parents[2] / "data" / "manifests"
"""Small pools that older revisions wrote."""


def edit(pool_folder, change):
    """Changes the manifest's JSON."""
    manifest = json.loads((pool_folder / "manifest.json").read_text())
    change(manifest)
    (pool_folder / "manifest.json").write_text(json.dumps(manifest))


def test_a_pool_is_what_was_written(pool_folder):
    pool = Pool.load(pool_folder)
    assert pool.name == "tiny"
    assert (pool.cooking, pool.mode) == ("auto", "sample")
    assert pool.layouts == ("cramped_room", "coordination_ring")
    assert [agent.name for agent in pool.agents("cramped_room")] == ["sp-0", "sp-1"]
    assert pool.agents("forced_coordination") == ()
    entry = pool.agent("cramped_room", "sp-1")
    assert entry.trained.seed == 2**63 + 5
    assert entry.trained.self_play.mean == 200
    assert entry.reference.weights.path == "cramped_room/sp-1.safetensors"
    policy = pool.policy("cramped_room", "sp-1")
    assert policy.sha256 == entry.sha256
    assert pool.policy("cramped_room", "sp-1") is policy
    assert Pool.load(str(pool_folder)).hash == pool.hash


def test_the_hash_covers_the_entries_but_not_their_order(pool_folder):
    before = Pool.load(pool_folder).hash
    edit(pool_folder, lambda manifest: manifest["entries"].reverse())
    assert Pool.load(pool_folder).hash == before
    write_manifest(pool_folder, "tiny", [record("sp-1", steps=11), record("sp-0"), record("sp-0", "coordination_ring")])
    assert Pool.load(pool_folder).hash != before


def test_a_manifest_needs_no_torch(pool_folder):
    code = (
        "import sys; from overcooked_bench.agents.pools.pool import Pool; "
        f"Pool.load({str(pool_folder)!r}).hash; print({{'torch', 'numba'}} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


@pytest.mark.parametrize(
    ("name", "form", "sha256"),
    [
        ("dev-v0", 1, "ecd9149914f58d408febc4a21f7e71259461f87a9f0ba234f89595b1e30ff94c"),
        ("dev-v1", 2, "33b0495a6d"),
        ("train-v1", 2, "70da1c512c"),
        ("human-train", 3, "25abbd042f"),
        ("human-test", 3, "21d6175bc1"),
        ("v1", 3, "c246f4c7"),
    ],
)
def test_the_shipped_pools_keep_their_hashes(name, form, sha256):
    manifest = read_manifest(find_pool(name))
    assert manifest.format == form
    assert manifest.hash.startswith(sha256)


@pytest.mark.parametrize("form", [1, 2])
def test_pools_of_older_formats_are_read_with_the_scripted_partners_of_their_protocol(form):
    pool = Pool.load(GOLDEN / f"format-{form}")
    assert (pool.name, pool.manifest.format, pool.layouts) == (f"golden-{form}", form, ("cramped_room",))
    assert [(entry.name, entry.role, entry.stratum) for entry in pool.partners("cramped_room")] == [
        ("dish_courier", "partner", "scripted"),
        ("greedy", "partner", "scripted"),
        ("onion_courier", "partner", "scripted"),
        ("random", "floor", "scripted"),
        ("sp-0", "partner", "self-play"),
        ("sp-1", "partner", "self-play" if form == 1 else "half-trained"),
        ("stay", "floor", "scripted"),
    ]
    assert [entry.name for entry in pool.agents("cramped_room")] == ["sp-0", "sp-1"], "nobody trains on scripted ones"
    agent = pool.agent("cramped_room", "sp-1")
    assert agent.lineage == "cramped_room/sp-1"
    assert (agent.trained.method, agent.trained.seed, agent.trained.steps) == ("self-play", 4, 10)
    newer = (agent.trained.configuration, agent.trained.checkpoint, agent.trained.profile and "told")
    assert newer == ((None, None, None) if form == 1 else ("fast", 0.5, "told"))
    assert pool.policy("cramped_room", "sp-1").sha256 == agent.sha256


@pytest.mark.parametrize(
    ("form", "change", "message"),
    [
        (1, lambda m: m["agents"][0].update(steps=99), "hash does not match"),
        (1, lambda m: m["agents"][0].update(checkpoint=0.5), "has .checkpoint., which came with format 2"),
        (2, lambda m: m["agents"][0].pop("profile"), "lacks .profile."),
        (2, lambda m: m["agents"][0].update(cooking="manual"), "make one pool of each"),
        (2, lambda m: m["agents"][0].update(surprise=1), "unknown field `surprise`"),
        (2, lambda m: m.update(agents=[3]), "Expected `object`"),
        (2, lambda m: m.update(format=3), "unknown field `agents`"),
        (2, lambda m: m.update(format=1), "which came with format 2"),
        (2, lambda m: m.update(format=[2]), "reads formats 1 to 3"),
        (1, lambda m: m.update(format=True), "reads formats 1 to 3"),
    ],
)
def test_a_changed_manifest_of_an_older_format_is_refused(tmp_path, form, change, message):
    shutil.copytree(GOLDEN / f"format-{form}", tmp_path / "pool")
    edit(tmp_path / "pool", change)
    with pytest.raises(PoolError, match=message):
        Pool.load(tmp_path / "pool")


def test_every_kind_of_partner_is_written_and_read(pool_folder):
    reached = {"ceiling": 200.0, "low": 196.0, "high": 204.0, "episodes": 100}
    bound = Bound(side=1, floor=3.5, floor_agent="random", responder="br-0", responder_sha256="0" * 64, **reached)
    behaviour = BehaviourReference(behaviour={"does": "carry", "insist": True}, version=VERSION)
    entries = [
        record("sp-0", convention="left", bounds=(bound,), weight=0.25),
        scripted("greedy"),
        scripted("stay", role="floor"),
        msgspec.structs.replace(scripted("rude"), reference=behaviour),
    ]
    write_manifest(pool_folder, "tiny", entries)
    pool = Pool.load(pool_folder)
    found = {entry.name: entry for entry in pool.partners("cramped_room")}
    assert (found["sp-0"].convention, found["sp-0"].bounds, found["sp-0"].weight) == ("left", (bound,), 0.25)
    assert found["greedy"].sha256 == find("greedy").sha256
    assert found["stay"].role == "floor"
    assert found["rude"].reference == behaviour
    assert found["rude"].sha256 == find(behaviour.behaviour).sha256, "and that of a behaviour too"
    assert len({entry.sha256 for entry in found.values()}) == 4
    for entry in found.values():
        check_version(pool.manifest, entry)
    again = write_manifest(pool_folder, "tiny", pool.partners("cramped_room"))
    assert again == pool.manifest


@pytest.mark.parametrize(
    ("reference", "message"),
    [
        (ScriptedReference(agent="greedy", version=2), "means version 2 of the scripted agent 'greedy'.*has version 1"),
        (ScriptedReference(agent="gredy", version=1), "no scripted agent 'gredy'; did you mean 'greedy'"),
        (BehaviourReference(behaviour={"does": "carry"}, version=99), "means version 99 of behaviours"),
    ],
)
def test_a_partner_of_another_version_is_not_played(pool_folder, reference, message):
    entry = msgspec.structs.replace(scripted("greedy"), reference=reference)
    manifest = write_manifest(pool_folder, "tiny", [entry])
    with pytest.raises(PoolError, match=message):
        check_version(manifest, entry)


GRID = "XXPXX\nO  2O\nX1  X\nXDXSX"


def test_scripted_partners_play_kitchens_of_the_users_own(pool_folder):
    write_manifest(pool_folder, "tiny", [record("sp-0"), scripted("greedy", layout=GRID)])
    assert Pool.load(pool_folder).layouts == ("cramped_room", GRID)
    for layout in (GRID + "\n", "XX\nXX", "../cramped_room"):
        with pytest.raises(PoolError, match="unknown layout"):
            write_manifest(pool_folder, "tiny", [scripted("greedy", layout=layout)])


def test_an_optional_key_that_is_left_out_leaves_the_hash_alone(pool_folder):
    """The hash of format 3 is frozen; a key that is added later defaults to None."""
    manifest = write_manifest(pool_folder, "frozen", [scripted("greedy"), scripted("stay", role="floor")])
    assert manifest.hash == "a86aea678adf7026d4b717b7ea46de496e380b81f863a69c07b1ab9028d69598"
    assert b"null" not in (pool_folder / "manifest.json").read_bytes()


BOUND = {"side": 0, "floor": 0.0, "floor_agent": "stay", "ceiling": 1.0, "low": 0.0, "high": 2.0, "episodes": 100}
BOUND |= {"responder": "x", "responder_sha256": "x"}


def first(manifest):
    return manifest["entries"][-1]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: first(m)["training"].update(steps=99), "hash does not match"),
        (lambda m: m.update(hash="0" * 64), "hash does not match"),
        (lambda m: m.update(name="other"), "hash does not match"),
        (lambda m: first(m)["reference"]["weights"].update(path="/etc/passwd"), "points outside"),
        (lambda m: first(m)["reference"]["weights"].update(path="../sp-0.safetensors"), "points outside"),
        (
            lambda m: first(m)["reference"]["weights"].update(path="cramped_room/x.safetensors"),
            "is not this agent's file",
        ),
        (lambda m: first(m).update(name="../sp-0"), "at most 100 letters, digits"),
        (lambda m: m.update(name="../tiny"), "the pool's name is '../tiny'"),
        (lambda m: first(m).update(layout="cramped_rom"), "did you mean 'cramped_room'"),
        (lambda m: first(m).update(cooking="manual"), "unknown field `cooking`"),
        (lambda m: first(m).update(role="friend"), "Invalid enum value 'friend'"),
        (lambda m: first(m).update(stratum=" "), "its stratum is empty"),
        (lambda m: first(m).update(reference={"kind": "scripted", "agent": "greedy", "version": 1}), "no training"),
        (lambda m: first(m).update(reference={"kind": "magic"}), "Invalid value 'magic'"),
        (lambda m: first(m).pop("training"), "lacks 'training'"),
        (lambda m: first(m).update(bounds=[BOUND, BOUND]), "give each side once"),
        (lambda m: first(m).update(weight=1.5), "give its share of its stratum"),
        (lambda m: first(m)["training"].update(seed="5"), r"entries\[2\].training.seed"),
        (lambda m: first(m).pop("lineage"), "lineage"),
        (lambda m: first(m).update(surprise=1), "unknown field `surprise`"),
        (lambda m: m["entries"].append(first(m)), "2 agents are named"),
        (lambda m: m.update(entries=[]), "lists no partners"),
        (lambda m: m.update(format=4), "reads formats 1 to 3"),
        (lambda m: m.update(format=2), "unknown field `entries`"),
        (lambda m: first(m)["training"].update(checkpoint=1.5), "share of the training done"),
    ],
    ids=[
        *("entry", "hash", "name", "absolute", "parent", "other-file", "bad-name", "pool-name", "unknown-layout"),
        *("cooking", "role", "stratum", "training", "kind", "untrained", "bounds", "weight"),
        *("type", "missing", "unknown", "duplicate", "empty", "format", "older", "checkpoint"),
    ],
)
def test_a_changed_manifest_is_refused(pool_folder, change, message):
    edit(pool_folder, change)
    with pytest.raises(PoolError, match=message) as error:
        Pool.load(pool_folder)
    assert "manifest.json" in str(error.value)


@pytest.mark.parametrize("suffix", ["safetensors", "json"])
def test_changed_and_missing_files_are_named(pool_folder, suffix):
    file = pool_folder / "cramped_room" / f"sp-1.{suffix}"
    file.write_bytes(file.read_bytes() + b" ")
    with pytest.raises(PoolError, match=rf"agent cramped_room/sp-1: .*sp-1\.{suffix} is not the file"):
        Pool.load(pool_folder)
    file.unlink()
    with pytest.raises(PoolError, match=rf"agent cramped_room/sp-1: .*sp-1\.{suffix}: cannot be read"):
        Pool.load(pool_folder)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="no pipes on this system")
@pytest.mark.parametrize("what", ["pipe", "loop", "folder", "device"])
def test_what_is_no_regular_file_is_refused_at_once(pool_folder, what):
    file = pool_folder / "cramped_room" / "sp-0.safetensors"
    file.unlink()
    {
        "pipe": lambda: os.mkfifo(file),
        "loop": lambda: file.symlink_to(file),
        "folder": file.mkdir,
        "device": lambda: file.symlink_to("/dev/zero"),
    }[what]()
    with pytest.raises(PoolError, match=r"agent cramped_room/sp-0: .*sp-0\.safetensors"):
        Pool.load(pool_folder)


def test_a_link_out_of_the_folder_is_refused(pool_folder, tmp_path):
    file = pool_folder / "cramped_room" / "sp-0.safetensors"
    file.rename(tmp_path / "elsewhere")
    file.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(PoolError, match=r"agent cramped_room/sp-0: .* outside the pool's folder"):
        Pool.load(pool_folder)


def test_a_file_that_changes_after_loading_is_not_played(pool_folder):
    pool = Pool.load(pool_folder)
    write_policy(pool_folder / "cramped_room" / "sp-0", 7)
    with pytest.raises(PoolError, match="is not the file"):
        pool.policy("cramped_room", "sp-0")


def test_the_same_policy_twice_is_refused(pool_folder):
    write_policy(pool_folder / "cramped_room" / "sp-2", 1)
    with pytest.raises(PoolError, match="cramped_room/sp-1, cramped_room/sp-2 have the same weights"):
        write_manifest(pool_folder, "tiny", [record("sp-1"), record("sp-2")])


def test_manifests_are_not_written_of_pools_that_could_not_be_read(pool_folder):
    before = (pool_folder / "manifest.json").read_bytes()
    with pytest.raises(PoolError, match=r"sp-9\.safetensors"):
        write_manifest(pool_folder, "tiny", [record("sp-9")])
    with pytest.raises(PoolError, match="layout 'cramped_room' and cooking 'auto'"):
        write_manifest(pool_folder, "tiny", [record("sp-0")], cooking="manual")
    with pytest.raises(PoolError, match="steps"):
        write_manifest(pool_folder, "tiny", [record("sp-0", steps=1.5)])
    (pool_folder / "cramped_room" / "sp-0.json").write_text("{}")
    with pytest.raises(PolicyError, match=r"sp-0\.json"):
        write_manifest(pool_folder, "tiny", [record("sp-0")])
    assert (pool_folder / "manifest.json").read_bytes() == before


def test_unknown_pools_and_agents_are_told(pool_folder, tmp_path):
    with pytest.raises(PoolError, match="no pool named 'nowhere'"):
        Pool.load("nowhere")
    (tmp_path / "empty").mkdir()
    with pytest.raises(PoolError, match=r"a folder with a manifest\.json"):
        Pool.load(tmp_path / "empty")
    pool = Pool.load(pool_folder)
    with pytest.raises(PoolError, match="no agents for 'counter_circuit'"):
        pool.agent("counter_circuit", "sp-0")
    with pytest.raises(PoolError, match="did you mean 'sp-1'"):
        pool.agent("cramped_room", "ps-1")


@pytest.mark.parametrize("content", [b"", b"[]", b"\xff", b"{"])
def test_a_broken_manifest_is_refused(tmp_path, content):
    (tmp_path / "manifest.json").write_bytes(content)
    with pytest.raises(PoolError, match=r"manifest\.json"):
        read_manifest(tmp_path)


def test_a_release_candidate_keeps_its_hash_when_it_is_frozen(pool_folder):
    frozen = read_manifest(pool_folder)
    candidate = write_manifest(pool_folder, frozen.name, frozen.entries, frozen=False)
    assert read_manifest(pool_folder) == candidate
    assert (frozen.frozen, candidate.frozen, Pool.load(pool_folder).frozen) == (True, False, False)
    assert candidate.hash == frozen.hash
    file = pool_folder / "manifest.json"
    file.write_text(file.read_text().replace(',\n  "frozen": false', ""))
    assert read_manifest(pool_folder) == frozen


def test_all_shipped_pools_together_are_smaller_than_64_mb():
    sizes = [file.stat().st_size for name in shipped_pools() for file in find_pool(name).rglob("*") if file.is_file()]
    assert 0 < sum(sizes) < 64_000_000


def test_shipped_pools_are_whole():
    for name in shipped_pools():
        pool = Pool.load(name)
        assert pool.name == name
        for layout in pool.layouts:
            for agent in pool.agents(layout):
                assert pool.policy(layout, agent.name).architecture.layout == layout


def test_a_manifest_names_the_people_behind_its_agents(pool_folder):
    entries = [record("sp-0", people=("2019-07",), method="human-proxy", checkpoint=0.5), record("sp-1")]
    manifest = write_manifest(pool_folder, "tiny", entries)
    assert (people_of(manifest), people_of(manifest, "coordination_ring")) == (("2019-07",), ())
    assert [entry.people for entry in read_manifest(pool_folder).entries] == [("2019-07",), None]
    assert [entry.trained.stratum for entry in manifest.entries] == ["human", "self-play"]
    for people in ((), ("a", "a"), (" ",)):
        with pytest.raises(PoolError, match=r"its people are \["):
            write_manifest(pool_folder, "tiny", [record("sp-0", people=people)])
