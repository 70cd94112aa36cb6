import pytest

from overcooked_bench.agents.pools.manifest import write_manifest
from tests.agents.made import record, write_policy

RING = {"layout": "coordination_ring", "shape": (22, 5, 5)}


@pytest.fixture
def pool_folder(tmp_path):
    """A pool of three agents on two layouts."""
    home = tmp_path / "pool"
    write_policy(home / "cramped_room" / "sp-0", 0)
    write_policy(home / "cramped_room" / "sp-1", 1)
    write_policy(home / "coordination_ring" / "sp-0", 2, **RING)
    write_manifest(home, "tiny", [record("sp-1"), record("sp-0"), record("sp-0", "coordination_ring")])
    return home
