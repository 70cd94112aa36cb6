"""Protocols, pool configurations, presets of training methods, and behaviours of scripted partners."""

import json

import numpy as np
import yaml

from overcooked_bench.agents.agent import UnknownLayout
from overcooked_bench.agents.behaviours.behaviour import ScriptAgent
from overcooked_bench.agents.behaviours.parsing import behaviour_from_text, parse_behaviour
from overcooked_bench.baselines import presets
from overcooked_bench.baselines.building.config import PoolConfigError, load_pool_config, pool_config_names
from overcooked_bench.baselines.presets import PresetError, config_names, load_config
from overcooked_bench.evaluation.protocol import ProtocolError, load_protocol
from overcooked_bench.kitchen.kitchens import Kitchens
from overcooked_bench.shelf import Shelf
from tests.baselines.pools import THREE_AGENTS, group
from tests.evaluation.made import protocol_text
from tests.fuzz.harness import TRIES, attack, mixed, seeded
from tests.fuzz.mutators import as_json, bytes_of, lines_of, trees_of, written


def shipped(package: str, folder: str = "") -> list[bytes]:
    shelf = Shelf("file", package, ".yaml", ValueError, "a file", folder)
    return [(shelf.home / f"{name}.yaml").read_bytes() for name in shelf.names()]


def of_yaml(seeds: list[bytes], name: str):
    rng = seeded(name)
    trees = as_json(trees_of([yaml.safe_load(seed) for seed in seeds], rng))
    return mixed(rng, bytes_of(seeds, rng), lines_of(seeds, rng), trees)


@TRIES
def test_protocols(tries, tmp_path):
    file = tmp_path / "p.yaml"

    def read(content: bytes) -> None:
        file.write_bytes(content)
        protocol = load_protocol(file)
        assert len(protocol.sha256) == len(protocol.report_sha256) == 64

    seeds = [*shipped("overcooked_bench.protocols"), protocol_text().encode()]
    attack("protocol YAML", seeds, of_yaml(seeds, "protocols"), read, ProtocolError, tries).check()


@TRIES
def test_pool_configurations(tries, tmp_path):
    file = tmp_path / "c.yaml"
    tiny = {"name": "tiny", "namespace": "n", "layouts": ["cramped_room"], "groups": [group(**THREE_AGENTS)]}

    def read(content: bytes) -> None:
        file.write_bytes(content)
        for run in load_pool_config(file).runs():
            assert "/" not in run.name

    seeds = [*shipped("overcooked_bench.baselines", "configs/pools"), json.dumps(tiny).encode()]
    assert len(seeds) == 1 + len(pool_config_names())
    attack("pool configuration", seeds, of_yaml(seeds, "pool configurations"), read, PoolConfigError, tries).check()


@TRIES
def test_presets(tries, tmp_path, monkeypatch):
    (tmp_path / "configs").mkdir()
    monkeypatch.setattr(presets, "files", lambda _: tmp_path)

    def read(content: bytes) -> None:
        (tmp_path / "configs" / "self-play.yaml").write_bytes(content)
        for name in config_names("self-play"):
            load_config("self-play", name, layout="cramped_room")

    seeds = shipped("overcooked_bench.baselines", "configs")
    attack("presets", seeds[-1:], of_yaml(seeds, "presets"), read, (PresetError, ValueError), tries).check()


BEHAVIOURS = [
    {"does": "carry", "insist": True},
    {"does": "script", "actions": ["up", "stay*2", "interact"], "then": {"does": "goto", "cell": [1, 1]}},
    {"does": "loop", "actions": ["left", "right"], "from": 2, "until": 5, "then": [2, 1]},
    {"does": "pace", "cells": [[1, 1], [3, 2]], "every": 2, "yields": True},
    {"does": "dumper", "counters": [[0, 0], [1, 0]], "item": "dish", "noisy": {"p": 0.1, "seed": 3}},
    {"does": "helper", "counters": [[2, 3]], "then": "frozen"},
]


@TRIES
def test_behaviours(tries):
    kitchens = Kitchens("cramped_room", 1)
    kitchens.reset(seed=0)
    state = [kitchens.state(0)]

    def read(content: bytes) -> None:
        agent = ScriptAgent(behaviour_from_text(content.decode("utf-8", "surrogateescape")))
        agent.reset("cramped_room", np.zeros(1, np.int64), np.zeros(1, np.uint64))
        for _ in range(3):
            assert 0 <= agent.act(state)[0] < 6

    rng = seeded("behaviours")
    whole = [*(written(one).encode() for one in BEHAVIOURS), b"{does: carry, insist: true}", b"plater"]
    trees = as_json(trees_of(BEHAVIOURS, rng))
    attack(
        "script:{...}", whole, mixed(rng, bytes_of(whole, rng), trees), read, (ValueError, UnknownLayout), tries
    ).check()


@TRIES
def test_behaviours_as_mappings(tries):
    rng = seeded("mappings")
    trees = trees_of(BEHAVIOURS, rng)

    def read(_: bytes) -> None:
        parse_behaviour(next(trees))

    attack("behaviour mapping", [], as_json(trees_of(BEHAVIOURS, rng)), read, ValueError, tries).check()
