"""Small files that hung a reader, filled the memory, reached out of their folder, or ended in a traceback."""

import json
import os
import time
from pathlib import Path

import msgspec
import pytest

from overcooked_bench.agents.behaviours.parsing import behaviour_from_text
from overcooked_bench.agents.catalogue import load_agent
from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool, PoolError
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.baselines.building.build import PoolBuildError, publish
from overcooked_bench.baselines.building.config import PoolConfigError, load_pool_config
from overcooked_bench.baselines.presets import PresetError, load_config
from overcooked_bench.baselines.running.place import CheckpointError, read_record
from overcooked_bench.evaluation.cells import read_cells
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.protocol import ProtocolError, load_protocol, read_protocol
from overcooked_bench.evaluation.scores import ScoresError, read_scores
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.items import load_items
from overcooked_bench.scenarios.language.loading import load_scenario
from overcooked_bench.scenarios.plugin.bench import read_known
from overcooked_bench.scenarios.shown.comparing import read_report
from tests.agents.made import record, write_policy
from tests.baselines.pools import group, pool_config
from tests.evaluation.games.test_store import FACTS, episode
from tests.evaluation.made import protocol_text
from tests.scenarios.writing import POT, edited

BOMB = "a0: &a0 {x: 1}\n" + "".join(f"a{i}: &a{i} {{<<: [{', '.join([f'*a{i - 1}'] * 9)}]}}\n" for i in range(1, 10))
YAML = {
    "integer": ("!!int ''", "the tag"),
    "truth": ("!!bool x", "the tag"),
    "time": ("!!timestamp x", "the tag"),
    "code": ("!!python/object/apply:os.getcwd []", "the tag"),
    "deep": ("[" * 1000, "inside each other"),
    "references": ("{a: &a [1], b: *a}", "references"),
    "merge": ("{<<: {a: 1}}", "merge"),
    "control": ('"\\0"', "the character"),
    "surrogate": ('"\\ud800"', "the character"),
    "infinite": (".inf", "not a finite number"),
}


@pytest.fixture(autouse=True)
def soon():
    began = time.perf_counter()
    yield
    assert time.perf_counter() - began < 20


@pytest.mark.parametrize(("value", "message"), YAML.values(), ids=YAML.keys())
def test_every_yaml_file_is_read_by_the_same_reader(value, message, tmp_path):
    file = tmp_path / "S01-x.scenario.yaml"
    file.write_text(edited(POT, id="S01-x", why=value))
    with pytest.raises(ScenarioError, match=rf"x\.scenario\.yaml:\d+: .*{message}"):
        load_scenario(file)
    with pytest.raises(ProtocolError, match=rf"p\.yaml:\d+: .*{message}"):
        read_protocol(protocol_text(salt="SALT").replace("SALT", value), "p.yaml")
    file = tmp_path / "c.yaml"
    file.write_text(f"name: tiny\nnamespace: {value}\n")
    with pytest.raises(PoolConfigError, match=rf"c\.yaml:2: .*{message}"):
        load_pool_config(file)
    with pytest.raises(ValueError, match=message):
        behaviour_from_text(f"{{does: {value}}}")
    with pytest.raises(AgentError, match=message):
        load_agent(f"script:{{does: {value}}}", "cramped_room")


def test_a_bomb_of_merge_keys_goes_off_nowhere(tmp_path):
    (tmp_path / "p.yaml").write_text(BOMB)
    with pytest.raises(ProtocolError, match=r"p\.yaml:1: references"):
        load_protocol(tmp_path / "p.yaml")


NAMES = ["../../X", "/tmp/X", "a/b", ".hidden", "..", "x" * 200]


@pytest.mark.parametrize("name", NAMES)
def test_names_from_files_never_become_paths(name, tmp_path):
    with pytest.raises(ProtocolError, match="name"):
        read_protocol(protocol_text(name=name), "p.yaml")
    write_policy(tmp_path / "cramped_room" / "sp-0")
    with pytest.raises(PoolError, match="the pool's name is"):
        write_manifest(tmp_path, name, [record("sp-0")])
    with pytest.raises(PoolConfigError, match="the key `name` is"):
        pool_config(tmp_path, name=name)
    with pytest.raises(PoolConfigError, match="the key `prefix` is"):
        pool_config(tmp_path, group(prefix=name))


def test_counts_that_would_fill_the_memory_are_refused(tmp_path):
    with pytest.raises(ProtocolError, match="episodes is 200000000; give a number from 1 to 10,000"):
        read_protocol(protocol_text(episodes=200_000_000), "p.yaml")
    with pytest.raises(PoolConfigError, match="count is 100000000; give a number from 1 to 1,000"):
        pool_config(tmp_path, group(count=100_000_000))
    (tmp_path / "many.py").write_text("TRAINING_SEEDS = 10**7\ndef make_agent(layout, training_seed): ...\n")
    with pytest.raises(AgentError, match="TRAINING_SEEDS is 10000000"):
        load_agent(tmp_path / "many.py", "cramped_room")


@pytest.fixture
def pool(tmp_path):
    for i in range(2):
        write_policy(tmp_path / "pool" / "cramped_room" / f"sp-{i}", i)
    write_manifest(tmp_path / "pool", "tiny", [record("sp-0"), record("sp-1")])
    return tmp_path / "pool"


@pytest.mark.skipif(os.name != "posix", reason="pipes and devices")
@pytest.mark.parametrize("name", ["manifest.json", "cramped_room/sp-1.json", "cramped_room/sp-1.safetensors"])
@pytest.mark.parametrize("kind", ["pipe", "device", "itself"])
def test_a_pool_consists_of_regular_files(pool, name, kind):
    file = pool / name
    file.unlink()
    os.mkfifo(file) if kind == "pipe" else file.symlink_to("/dev/zero" if kind == "device" else file)
    with pytest.raises(PoolError):
        Pool.load(pool)


READERS = {
    "manifest": (lambda folder: Pool.load(folder), "manifest.json", PoolError),
    "score": (lambda folder: read_scores(folder / "score.json"), "score.json", ScoresError),
    "report": (lambda folder: read_report(folder / "report.json"), "report.json", ScenarioError),
    "training": (lambda folder: read_record(folder / "config.json", dict), "config.json", CheckpointError),
    "known": (lambda folder: read_known(folder / "known.txt"), "known.txt", ScenarioError),
    "scenario": (lambda folder: load_scenario(folder / "a.scenario.yaml"), "a.scenario.yaml", ScenarioError),
    "protocol": (lambda folder: load_protocol(folder / "p.yaml"), "p.yaml", ProtocolError),
    "pool configuration": (lambda folder: load_pool_config(folder / "c.yaml"), "c.yaml", PoolConfigError),
}


@pytest.mark.parametrize(("read", "name", "error"), READERS.values(), ids=READERS.keys())
@pytest.mark.parametrize("content", ["deep", "pipe", "device", "bytes", "folder"])
def test_every_reader_refuses_what_is_none_of_its_files(read, name, error, content, tmp_path):
    file = tmp_path / name
    make = {
        "deep": lambda: file.write_text("{a b: " + "[" * 3000),
        "pipe": lambda: os.mkfifo(file),
        "device": lambda: file.symlink_to("/dev/zero"),
        "bytes": lambda: file.write_bytes(b"\xff\xfe\x00"),
        "folder": file.mkdir,
    }
    make[content]()
    with pytest.raises(error) as refused:
        read(tmp_path)
    assert file.name in str(refused.value)


def test_json_that_is_nested_deep_is_no_recursion_error(tmp_path):
    file = tmp_path / "f.json"
    file.write_text('{"schema": 1, "items": ' + "[" * 1500 + "]" * 1500 + "}")
    for read, error in ((read_scores, ScoresError), (read_report, ScenarioError)):
        with pytest.raises(error, match=r"f\.json"):
            read(file)
    with pytest.raises(CheckpointError, match=r"f\.json"):
        read_record(file, dict)


def test_a_score_of_schema_1_without_partners_is_no_division_by_zero(tmp_path):
    old = json.loads((Path(__file__).parent / "data" / "upgrades" / "score-1" / "score.json").read_text())
    old["layouts"][0]["partners"] = 0
    (tmp_path / "score.json").write_text(json.dumps(old))
    with pytest.raises(ScoresError, match=r"score\.json: not a score\.json of schema 1"):
        read_scores(tmp_path / "score.json")


@pytest.mark.parametrize("notes", ["[" * 3000, '{"cramped_room": {"greedy": 1}}', "{", '["cramped_room"]'])
def test_what_a_store_says_of_partners_is_not_trusted(notes, tmp_path):
    with Store(tmp_path / "episodes.sqlite", FACTS, {"partners": notes}) as store:
        store.add_block(("cramped_room", 0, 0), [episode()])
        with pytest.raises(StoreError, match=r"episodes\.sqlite"):
            read_cells(store, ["cramped_room"], 1, 1, [0])


def test_an_agent_that_does_not_say_how_it_was_trained_is_not_published(tmp_path):
    (chosen,) = pool_config(tmp_path, group()).runs()
    entry = msgspec.to_builtins(record(chosen.agent("final"), training=None))
    (tmp_path / "agents.json").write_text(json.dumps({"seconds": 1, "agents": [{"policy": "p", "record": entry}]}))
    with pytest.raises(PoolBuildError, match="does not say how it was trained"):
        publish(chosen, tmp_path, tmp_path)


def test_a_policy_outside_the_runs_folder_is_not_published(tmp_path):
    (chosen,) = pool_config(tmp_path, group()).runs()
    training = {"method": "self-play", "seed": chosen.seed, "configuration": chosen.configuration, "settings": {}}
    entry = msgspec.to_builtins(record(chosen.agent("final"), **training))
    (tmp_path / "run").mkdir()
    content = {"seconds": 1, "agents": [{"policy": "../../../etc/p", "record": entry}]}
    (tmp_path / "run" / "agents.json").write_text(json.dumps(content))
    with pytest.raises(PoolBuildError, match="is not in this folder"):
        publish(chosen, tmp_path / "run", tmp_path)


def test_a_neighbour_of_half_a_pair_may_be_anything(tmp_path):
    half = edited(POT, id="S01-a", pair="S01-both")
    (tmp_path / "S01-a.scenario.yaml").write_text(half)
    (tmp_path / "S01-b.scenario.yaml").write_text(half.replace("S01-a", "S01-b"))
    os.mkfifo(tmp_path / "S01-c.scenario.yaml")
    (tmp_path / "S01-d.scenario.yaml").symlink_to("/dev/zero")
    assert [item.id for item in load_items(str(tmp_path / "S01-a.scenario.yaml"))] == ["S01-both-pair"]


@pytest.mark.parametrize("word", ["x" * 5000, "a\0b", "\ud800", "[" * 500, "x" * 300 + ".yaml"])
def test_words_that_cannot_be_paths_choose_nothing(word):
    with pytest.raises(ScenarioError):
        load_items(word)


def test_a_file_that_is_no_scenario_says_how_it_has_to_be_named(tmp_path):
    (tmp_path / "S01-a.yaml").write_text(edited(POT, id="S01-a"))
    with pytest.raises(ScenarioError, match=r"S01-a\.yaml: a scenario's file is its id and \.scenario\.yaml; rename"):
        load_items(tmp_path / "S01-a.yaml")


CONFIGURATIONS = {
    "a circle": ("a: {extends: b}\nb: {extends: a}", "extends itself"),
    "a number as base": ("a: {extends: 3}", "self-play.yaml:1: .*extends"),
    "layouts that are a number": ("a: {by_layout: 3}", "self-play.yaml:1: .*by_layout"),
    "a number": ("a: 3", "self-play.yaml:1: "),
    "nothing": ("{}", "no configurations"),
}


@pytest.mark.parametrize(("text", "message"), CONFIGURATIONS.values(), ids=CONFIGURATIONS.keys())
def test_configurations_of_a_method_are_checked(text, message, tmp_path, monkeypatch):
    (tmp_path / "configs").mkdir()
    (tmp_path / "configs" / "self-play.yaml").write_text(text)
    monkeypatch.setattr("overcooked_bench.baselines.presets.files", lambda _: tmp_path)
    with pytest.raises(PresetError, match=message):
        load_config("self-play", layout="cramped_room")


@pytest.mark.parametrize("content", ["[1]", "3", '[{"seed": "x"}]', '{"a":' * 1000])
def test_damaged_files_of_a_run_are_one_error(content, tmp_path):
    (tmp_path / "restarts.json").write_text(content)
    with pytest.raises(CheckpointError, match=r"restarts\.json.*choose another --output"):
        read_record(tmp_path / "restarts.json", list[dict[str, int | float]])
    assert read_record(tmp_path / "gone.json", dict) is None
