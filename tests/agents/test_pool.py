import json
import subprocess
import sys

import pytest

from overcooked_bench.agents.policy import PolicyError
from overcooked_bench.agents.pool import (
    AgentRecord,
    Pool,
    PoolError,
    SelfPlay,
    read_manifest,
    shipped_pools,
    write_manifest,
)
from tests.agents.policies import write_policy

RING = {"layout": "coordination_ring", "shape": (22, 5, 5)}


def record(name="sp-0", layout="cramped_room", **others):
    settings = {
        "method": "self-play",
        "seed": 2**63 + 5,
        "namespace": "tests",
        "lineage": f"{layout}/{name}",
        "training": {"learning_rate": 1e-3, "hidden": (128, 128), "steps": 10},
        "steps": 10,
        "cooking": "auto",
        "mode": "sample",
        "self_play": SelfPlay(mean=200, low=190.5, high=210.0, episodes=100),
    }
    return AgentRecord(name=name, layout=layout, **(settings | others))


@pytest.fixture
def folder(tmp_path):
    """A pool of three agents on two layouts."""
    home = tmp_path / "pool"
    write_policy(home / "cramped_room" / "sp-0", 0)
    write_policy(home / "cramped_room" / "sp-1", 1)
    write_policy(home / "coordination_ring" / "sp-0", 2, **RING)
    write_manifest(home, "tiny", [record("sp-1"), record("sp-0"), record("sp-0", "coordination_ring")])
    return home


def edit(folder, change):
    """Changes the manifest's JSON."""
    manifest = json.loads((folder / "manifest.json").read_text())
    change(manifest)
    (folder / "manifest.json").write_text(json.dumps(manifest))


def test_a_pool_is_what_was_written(folder):
    pool = Pool.load(folder)
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
    assert Pool.load(str(folder)).hash == pool.hash


def test_the_hash_covers_the_entries_but_not_their_order(folder):
    before = Pool.load(folder).hash
    edit(folder, lambda manifest: manifest["agents"].reverse())
    assert Pool.load(folder).hash == before
    write_manifest(folder, "tiny", [record("sp-1", steps=11), record("sp-0"), record("sp-0", "coordination_ring")])
    assert Pool.load(folder).hash != before


def test_a_manifest_needs_no_torch(folder):
    code = (
        "import sys; from overcooked_bench.agents.pool import Pool; "
        f"Pool.load({str(folder)!r}).hash; print({{'torch', 'numba'}} & set(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "set()"


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
        (lambda m: first(m).update(name="../sp-0"), "a name consists of"),
        (lambda m: first(m).update(layout="cramped_rom"), "did you mean 'cramped_room'"),
        (lambda m: first(m).update(cooking="manual"), "make one pool of each"),
        (lambda m: first(m).update(seed="5"), r"agents\[0\].seed"),
        (lambda m: first(m).pop("lineage"), "lineage"),
        (lambda m: first(m).update(surprise=1), "unknown field `surprise`"),
        (lambda m: m["agents"].append(first(m)), "2 agents are named"),
        (lambda m: m.update(agents=[]), "lists no agents"),
        (lambda m: m.update(format=2), "reads format 1"),
    ],
    ids=[
        *("entry", "hash", "name", "absolute", "parent", "other-file", "bad-name", "unknown-layout", "cooking"),
        *("type", "missing", "unknown", "duplicate", "empty", "format"),
    ],
)
def test_a_changed_manifest_is_refused(folder, change, message):
    edit(folder, change)
    with pytest.raises(PoolError, match=message) as error:
        Pool.load(folder)
    assert "manifest.json" in str(error.value)


@pytest.mark.parametrize("suffix", ["safetensors", "json"])
def test_changed_and_missing_files_are_named(folder, suffix):
    file = folder / "cramped_room" / f"sp-1.{suffix}"
    file.write_bytes(file.read_bytes() + b" ")
    with pytest.raises(PoolError, match=rf"agent cramped_room/sp-1: .*sp-1\.{suffix} is not the file"):
        Pool.load(folder)
    file.unlink()
    with pytest.raises(PoolError, match=rf"agent cramped_room/sp-1: .*sp-1\.{suffix} is missing"):
        Pool.load(folder)


def test_a_link_out_of_the_folder_is_refused(folder, tmp_path):
    file = folder / "cramped_room" / "sp-0.safetensors"
    file.rename(tmp_path / "elsewhere")
    file.symlink_to(tmp_path / "elsewhere")
    with pytest.raises(PoolError, match=r"agent cramped_room/sp-0: .* outside the pool's folder"):
        Pool.load(folder)


def test_a_file_that_changes_after_loading_is_not_played(folder):
    pool = Pool.load(folder)
    write_policy(folder / "cramped_room" / "sp-0", 7)
    with pytest.raises(PoolError, match="is not the file"):
        pool.policy("cramped_room", "sp-0")


def test_the_same_policy_twice_is_refused(folder):
    write_policy(folder / "cramped_room" / "sp-2", 1)
    with pytest.raises(PoolError, match="cramped_room/sp-1, cramped_room/sp-2 have the same weights"):
        write_manifest(folder, "tiny", [record("sp-1"), record("sp-2")])


def test_manifests_are_not_written_of_pools_that_could_not_be_read(folder):
    before = (folder / "manifest.json").read_bytes()
    with pytest.raises(PoolError, match=r"sp-9\.safetensors"):
        write_manifest(folder, "tiny", [record("sp-9")])
    with pytest.raises(PoolError, match="layout 'cramped_room' and cooking 'auto'"):
        write_manifest(folder, "tiny", [record("sp-0", cooking="manual")], cooking="manual")
    with pytest.raises(PoolError, match="steps"):
        write_manifest(folder, "tiny", [record("sp-0", steps=1.5)])
    (folder / "cramped_room" / "sp-0.json").write_text("{}")
    with pytest.raises(PolicyError, match=r"sp-0\.json"):
        write_manifest(folder, "tiny", [record("sp-0")])
    assert (folder / "manifest.json").read_bytes() == before


def test_unknown_pools_and_agents_are_told(folder, tmp_path):
    with pytest.raises(PoolError, match="no pool named 'nowhere'"):
        Pool.load("nowhere")
    (tmp_path / "empty").mkdir()
    with pytest.raises(PoolError, match=r"no manifest\.json in this folder"):
        Pool.load(tmp_path / "empty")
    pool = Pool.load(folder)
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
