import json
import subprocess
import sys

import pytest

from overcooked_bench.agents.policies.policy import PolicyError
from overcooked_bench.agents.pools.pool import (
    Pool,
    PoolError,
    read_manifest,
    shipped_pools,
    write_manifest,
)
from tests.agents.made import record, write_policy


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
    assert entry.seed == 2**63 + 5
    assert entry.self_play.mean == 200
    assert entry.files.weights.path == "cramped_room/sp-1.safetensors"
    policy = pool.policy("cramped_room", "sp-1")
    assert policy.sha256 == entry.files.weights.sha256
    assert pool.policy("cramped_room", "sp-1") is policy
    assert Pool.load(str(pool_folder)).hash == pool.hash


def test_the_hash_covers_the_entries_but_not_their_order(pool_folder):
    before = Pool.load(pool_folder).hash
    edit(pool_folder, lambda manifest: manifest["agents"].reverse())
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


def test_a_pool_of_format_1_is_read_as_it_was_written():
    pool = Pool.load("dev-v0")
    assert pool.manifest.format == 1
    assert pool.hash == "ecd9149914f58d408febc4a21f7e71259461f87a9f0ba234f89595b1e30ff94c"
    agent = pool.agent("cramped_room", "sp-0")
    assert (agent.configuration, agent.checkpoint, agent.profile, agent.trained) == (None, None, None, 1.0)


def first(manifest):
    return manifest["agents"][0]


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda m: first(m).update(steps=99), "hash does not match"),
        (lambda m: m.update(hash="0" * 64), "hash does not match"),
        (lambda m: m.update(name="other"), "hash does not match"),
        (lambda m: first(m)["files"]["weights"].update(path="/etc/passwd"), "points outside the pool's folder"),
        (lambda m: first(m)["files"]["weights"].update(path="../sp-0.safetensors"), "points outside"),
        (lambda m: first(m)["files"]["weights"].update(path="cramped_room/x.safetensors"), "is not this agent's file"),
        (lambda m: first(m).update(name="../sp-0"), "the name is"),
        (lambda m: first(m).update(layout="cramped_rom"), "did you mean 'cramped_room'"),
        (lambda m: first(m).update(cooking="manual"), "make one pool of each"),
        (lambda m: first(m).update(seed="5"), r"agents\[0\].seed"),
        (lambda m: first(m).pop("lineage"), "lineage"),
        (lambda m: first(m).update(surprise=1), "unknown field `surprise`"),
        (lambda m: m["agents"].append(first(m)), "2 agents are named"),
        (lambda m: m.update(agents=[]), "lists no agents"),
        (lambda m: m.update(format=3), "reads formats 1 and 2"),
        (lambda m: m.update(format=1), "has .configuration., which came with format 2"),
        (lambda m: first(m).pop("profile"), "lacks .profile."),
        (lambda m: first(m).update(checkpoint=1.5), "share of the training done"),
    ],
    ids=[
        *("entry", "hash", "name", "absolute", "parent", "other-file", "bad-name", "unknown-layout", "cooking"),
        *("type", "missing", "unknown", "duplicate", "empty", "format", "older"),
        *("no-profile", "checkpoint"),
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
        write_manifest(pool_folder, "tiny", [record("sp-0", cooking="manual")], cooking="manual")
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


def test_shipped_pools_are_whole():
    for name in shipped_pools():
        pool = Pool.load(name)
        assert pool.name == name
        for layout in pool.layouts:
            for agent in pool.agents(layout):
                assert pool.policy(layout, agent.name).architecture.layout == layout
