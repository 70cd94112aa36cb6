import hashlib

import pytest

from overcooked_bench.agents.pools.pool import shipped_pools
from overcooked_bench.baselines.running.seeds import USER, derive_seed

LAYOUTS = ("cramped_room", "asymmetric_advantages", "coordination_ring", "forced_coordination", "counter_circuit")
POOLS = sorted({"dev-v0", "dev-v1", "train-v1", "v1", *shipped_pools()})


def test_a_seed_is_the_start_of_a_hash():
    expected = hashlib.sha256(b"dev-v0\ncramped_room\nself-play\n3").hexdigest()[:8]
    assert derive_seed("dev-v0", "cramped_room", "self-play", 3) == int(expected, 16)


def test_seeds_never_change():
    assert derive_seed("user", "cramped_room", "self-play", 0) == 4162901905
    assert derive_seed("dev-v0", "counter_circuit", "self-play", 2) == 3140726810


def test_no_seed_of_a_pool_is_within_reach_of_the_command_line():
    for layout in LAYOUTS:
        mine = {derive_seed(USER, layout, "self-play", k) for k in range(-100, 3000)}
        theirs = [derive_seed(pool, layout, "self-play", k) for pool in POOLS for k in range(100)]
        assert len(mine) == 3100
        assert len(set(theirs)) == len(theirs)
        assert mine.isdisjoint(theirs)


def test_every_part_matters_and_seeds_fit_every_generator():
    seeds = {
        derive_seed(space, layout, method, k)
        for space in (USER, "dev-v0")
        for layout in ("a", "a\nself-play", "XX\nXX")
        for method in ("self-play", "play")
        for k in range(12)
    }
    assert len(seeds) == 2 * 3 * 2 * 12
    assert all(0 <= seed < 2**32 for seed in seeds)


@pytest.mark.parametrize(("space", "method"), [("user\ncramped_room", "self-play"), ("user", "self\nplay")])
def test_names_of_several_lines_are_refused(space, method):
    with pytest.raises(ValueError, match="one line"):
        derive_seed(space, "cramped_room", method, 0)
