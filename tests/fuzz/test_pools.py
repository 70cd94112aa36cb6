"""Manifests whose hash was made right, policies' JSON and weights."""

import hashlib
import json
import shutil
from pathlib import Path
from typing import Any

import msgspec
import pytest

from overcooked_bench.agents.policies.policy import PolicyError, load_policy
from overcooked_bench.agents.pools.manifest import policies, write_manifest
from overcooked_bench.agents.pools.pool import Pool, PoolError
from overcooked_bench.agents.pools.records import Manifest
from tests.agents.made import record, scripted, write_policy
from tests.fuzz.harness import TRIES, attack, mixed, seeded
from tests.fuzz.mutators import as_json, bytes_of, trees_of

OLD = Path(__file__).parents[1] / "data" / "manifests"


@pytest.fixture(scope="module")
def pool(tmp_path_factory):
    home = tmp_path_factory.mktemp("fuzz") / "pool"
    for i in range(2):
        write_policy(home / "cramped_room" / f"sp-{i}", i)
    write_manifest(home, "tiny", [record("sp-0"), record("sp-1"), scripted("greedy"), scripted("random", role="floor")])
    return home


def rehashed(tree: Any) -> Any:
    """Makes the hash right, as somebody who knows the format would."""
    try:
        entries = sorted(tree["entries"], key=lambda entry: (entry["layout"], entry["name"]))
        manifest = msgspec.convert({**tree, "hash": "", "entries": entries}, Manifest)
        tree["hash"] = hashlib.sha256(msgspec.json.encode(manifest, order="sorted")).hexdigest()
    except (ValueError, TypeError, LookupError, RecursionError):
        pass
    return tree


@TRIES
def test_manifests(tries, pool):
    file = pool / "manifest.json"
    seed = file.read_bytes()
    seeds = [seed, *(old.read_bytes() for old in sorted(OLD.rglob("*.json")))]

    def read(content: bytes) -> None:
        file.write_bytes(content)
        found = Pool.load(pool)
        for entry in policies(found.manifest):
            found.policy(entry.layout, entry.name)

    rng = seeded("manifests")
    trees = trees_of([json.loads(seed)], rng)
    inputs = mixed(rng, bytes_of(seeds, rng), as_json(trees, rehashed), as_json(trees, rehashed))
    attack("manifest.json", [seed], inputs, read, (PoolError, PolicyError), tries).check()
    file.write_bytes(seed)


@TRIES
def test_architectures(tries, pool, tmp_path):
    shutil.copy(pool / "cramped_room" / "sp-0.safetensors", tmp_path / "p.safetensors")
    seed = (pool / "cramped_room" / "sp-0.json").read_bytes()
    cnn = {**json.loads(seed), "architecture": "cnn", "filters": 2, "previous": 0, "observation": "lossless"}
    cnn.pop("activation", None)

    def read(content: bytes) -> None:
        (tmp_path / "p.json").write_bytes(content)
        load_policy(tmp_path / "p.json")

    rng = seeded("architectures")
    inputs = mixed(rng, bytes_of([seed], rng), as_json(trees_of([json.loads(seed), cnn], rng)))
    attack("policy JSON", [seed], inputs, read, PolicyError, tries).check()


@TRIES
def test_weights(tries, pool, tmp_path):
    shutil.copy(pool / "cramped_room" / "sp-0.json", tmp_path / "p.json")
    seed = (pool / "cramped_room" / "sp-0.safetensors").read_bytes()
    size = int.from_bytes(seed[:8], "little")
    header, tensors = json.loads(seed[8 : 8 + size]), seed[8 + size :]

    def read(content: bytes) -> None:
        (tmp_path / "p.safetensors").write_bytes(content)
        load_policy(tmp_path / "p.json")

    def headed():
        for head in as_json(trees_of([header], rng)):
            yield len(head).to_bytes(8, "little") + head + tensors

    rng = seeded("weights")
    attack("safetensors", [seed], mixed(rng, bytes_of([seed], rng), headed()), read, PolicyError, tries).check()
