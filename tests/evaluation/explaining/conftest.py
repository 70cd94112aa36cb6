import shutil

import pytest

from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.evaluation.explaining.explain import explain
from overcooked_bench.evaluation.protocol import read_protocol
from tests.agents.made import scripted
from tests.evaluation.made import protocol_text, score

LAYOUT = "forced_coordination"
HABITS = "dev-v1/forced_coordination/sp-0"
"""A frozen policy that hands onions over at the bottom and dishes in the middle."""


@pytest.fixture(scope="session")
def strangers(tmp_path_factory):
    """A pool of sp-4, which hands everything over at the top, of two partners that do nothing good, and a floor."""
    home, source = tmp_path_factory.mktemp("pools") / "strangers", Pool.load("dev-v1")
    (home / LAYOUT).mkdir(parents=True)
    for suffix in (".json", ".safetensors"):
        shutil.copy(source.folder / LAYOUT / f"sp-4{suffix}", home / LAYOUT)
    entries = [source.agent(LAYOUT, "sp-4"), scripted("random", LAYOUT, role="floor")]
    write_manifest(home, "strangers", [*entries, scripted("stay", LAYOUT), scripted("onion_courier", LAYOUT)])
    return home


@pytest.fixture(scope="session")
def rules():
    """Episodes of 250 steps; no pool, whose folder would change what is drawn from one run of the tests to the next."""
    text = protocol_text(layouts=[LAYOUT], pool="null", horizon=250, episodes=10, object_probability=0.0)
    return read_protocol(text, "strangers.yaml")


@pytest.fixture(scope="session")
def scored(rules, strangers, tmp_path_factory):
    """The folder of a score of `HABITS`."""
    return score(HABITS, rules, pool=strangers, output=tmp_path_factory.mktemp("scores") / "habits").folder


@pytest.fixture(scope="session")
def explained(scored, strangers):
    """The same, explained."""
    return explain(scored, pool=strangers, moments=24)
