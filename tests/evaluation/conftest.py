import pytest

from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.evaluation.protocol import read_protocol
from tests.agents.made import record, scripted, write_policy
from tests.evaluation.made import protocol_text


@pytest.fixture(scope="session")
def pool_folder(tmp_path_factory):
    """Two random policies for cramped_room, `greedy` and, as a floor, `random`."""
    home = tmp_path_factory.mktemp("pools") / "tiny"
    for i in range(2):
        write_policy(home / "cramped_room" / f"sp-{i}", i)
    entries = [record("sp-0"), record("sp-1"), scripted("greedy"), scripted("random", role="floor")]
    write_manifest(home, "tiny", entries)
    return home


@pytest.fixture
def protocol():
    """One layout, two episodes of 40 steps, the partners `greedy` and, as a floor, `random`."""
    return read_protocol(protocol_text(), "tiny.yaml")


@pytest.fixture(scope="session")
def tiny():
    """The same as `protocol`, for fixtures of a module."""
    return read_protocol(protocol_text(), "tiny.yaml")
