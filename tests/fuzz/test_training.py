"""The JSON files of training runs: what `train --resume` and `pool build` find in a folder."""

import json
from pathlib import Path

import msgspec
import pytest

from overcooked_bench.agents.pools.pool import PoolError
from overcooked_bench.baselines.building.build import AGENTS_FILE, PoolBuildError, publish
from overcooked_bench.baselines.running.place import CONFIG_FILE, CheckpointError, Place
from overcooked_bench.baselines.running.run import RESTARTS, RESULT, UnfitError, claim, run
from overcooked_bench.baselines.self_play import Config
from tests.agents.made import record, write_policy
from tests.baselines.pools import group, pool_config
from tests.baselines.tiny import SETTINGS
from tests.fuzz.harness import TRIES, attack, mixed, seeded
from tests.fuzz.mutators import as_json, bytes_of, trees_of

CONFIG = Config(**SETTINGS)


class Reached(Exception):
    """The run was about to make its learner."""


def make(_: int) -> None:
    raise Reached


@TRIES
@pytest.mark.parametrize("name", [CONFIG_FILE, RESTARTS, RESULT])
def test_a_run_that_is_resumed(name, tries, tmp_path):
    claim(Place(tmp_path, 3), CONFIG, "self-play")
    write_policy(tmp_path / "policy", layout="cramped_room")
    seeds = {
        CONFIG_FILE: json.loads((tmp_path / CONFIG_FILE).read_text()),
        RESTARTS: [{"seed": 2**63 - 1, "joint_steps": 100, "soups": 0.5, "seconds": 1.5}] * 2,
        RESULT: {"steps": 100, "seconds": 1.5, "restarts": 0, "returns": [0.0, 20.0]},
    }

    def read(content: bytes) -> None:
        (tmp_path / name).write_bytes(content)
        try:
            run(CONFIG, "self-play", Place(tmp_path, 3, resume=True), make)
        except Reached:
            return

    rng, seed = seeded(name), seeds[name]
    whole = [json.dumps(seed, indent=2).encode()]
    inputs = mixed(rng, bytes_of(whole, rng), as_json(trees_of([seed], rng)))
    tally = attack(name, whole, inputs, read, (CheckpointError, UnfitError), tries)
    tally.check(refuses=name != RESULT)  # a damaged result is measured again


@TRIES
def test_agents_of_a_finished_run(tries, tmp_path):
    (chosen,) = pool_config(tmp_path, group()).runs()
    folder, pool = tmp_path / "run", tmp_path / "pool"
    write_policy(folder / "policy", layout="cramped_room")
    entry = record(chosen.agent("final"))
    training = msgspec.structs.replace(
        entry.training, method="self-play", seed=chosen.seed, configuration=chosen.configuration, settings={}
    )
    entry = msgspec.to_builtins(msgspec.structs.replace(entry, training=training, lineage=chosen.lineage))
    seed = {"seconds": 1.5, "agents": [{"policy": "policy", "record": entry}]}
    file = folder / AGENTS_FILE
    pool.mkdir()

    def read(content: bytes) -> None:
        file.write_bytes(content)
        publish(chosen, folder, pool)

    rng, whole = seeded("agents.json"), [json.dumps(seed).encode()]
    inputs = mixed(rng, bytes_of(whole, rng), as_json(trees_of([seed], rng)))
    attack("agents.json", whole, inputs, read, (CheckpointError, PoolBuildError, PoolError), tries).check()
    assert {path.parent for path in Path(tmp_path).rglob("*.safetensors")} <= {folder, pool / "cramped_room"}
