"""The list of hidden pools: what it promises, and that it is kept once a pool is revealed."""

import pytest

from overcooked_bench.agents.pools.pool import Pool, shipped_pools
from overcooked_bench.errors import WrongUse
from overcooked_bench.leaderboard.hidden import HIDDEN, hidden_pool, hidden_pools

LISTED = """pools:
  - name: v1-twin
    twin_of: v1
    sha256: {sha256}
    partners: 250
    published: "2026-12-01"
    revealed: {revealed}
"""


def test_every_hidden_pool_is_a_shipped_ones_twin_and_ships_with_its_hash_once_it_is_revealed():
    pools = hidden_pools()
    assert len({pool.sha256 for pool in pools}) == len(pools)
    for pool in pools:
        assert pool.twin_of in shipped_pools()
        assert (pool.revealed is not None) == (pool.name in shipped_pools())
        assert pool.revealed is None or Pool.load(pool.name).hash == pool.sha256


def test_a_pool_is_found_by_its_hash(tmp_path, monkeypatch):
    file = tmp_path / "hidden.yaml"
    file.write_text(LISTED.format(sha256="a" * 64, revealed="null"))
    monkeypatch.setattr("overcooked_bench.leaderboard.hidden.hidden_pools.__defaults__", (file,))
    found = hidden_pool("a" * 64)
    assert (found.name, found.partners, found.revealed) == ("v1-twin", 250, None)
    assert hidden_pool("b" * 64) is None


@pytest.mark.parametrize(
    ("old", "new"),
    [("a" * 64, "a" * 63), ("partners: 250", "partners: 0"), ('"2026-12-01"', "today"), ("    twin_of: v1\n", "")],
)
def test_a_list_with_a_mistake_names_its_line(old, new, tmp_path):
    file = tmp_path / "hidden.yaml"
    file.write_text(LISTED.format(sha256="a" * 64, revealed="null").replace(old, new))
    with pytest.raises(WrongUse, match=r"hidden\.yaml:\d"):
        hidden_pools(file)


def test_the_list_ships():
    assert HIDDEN.is_file()
