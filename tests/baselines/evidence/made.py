"""Small pools of random policies, and played episodes that are made up."""

from itertools import product

import numpy as np

from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Bound
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.evaluation.pools.players import Player, players_of
from tests.agents.made import record, scripted, write_policy

LAYOUT = "cramped_room"
BOUND = Bound(
    **{"side": 0, "floor": 20.0, "floor_agent": "stay", "ceiling": 220.0, "low": 215.0, "high": 225.0},
    **{"episodes": 100, "responder": "greedy", "responder_sha256": "0" * 64},
)
EPISODES = 2


def write_pool(home, name, agents, beside=()):
    """Writes a pool of policies: name -> keys of the entry or of its training."""
    for index, (agent, _) in enumerate(agents.items()):
        write_policy(home / name / LAYOUT / agent, seed=1000 * sum(map(ord, name)) + index)
    entries = [record(agent, lineage=f"{name}/{agent}", **keys) for agent, keys in agents.items()]
    write_manifest(home / name, name, [*entries, *beside])
    return Pool.load(home / name)


def write_pools(home):
    """Writes a pool with two strata, its twin, two pools of people's proxies, and twelve entrants of four families."""
    for name in ("tiny", "twin"):
        own = {
            "sp-0": {"stratum": "own", "weight": 0.6, "convention": "onions=top, dishes=left", "bounds": (BOUND,)},
            "sp-1": {"stratum": "own", "weight": 0.4, "convention": "onions=middle, dishes=left", "bounds": (BOUND,)},
        }
        person = {"stratum": "human", "method": "human-proxy", "people": ("p-0",), "bounds": (BOUND,)}
        write_pool(home, name, own | {"person-0": person}, [scripted("stay", role="floor")])
    write_pool(home, "human-test", {f"person-{i}": {"method": "human-proxy", "people": ("p-1",)} for i in range(2)})
    write_pool(home, "human-train", {"person-0": {"method": "human-proxy", "people": ("p-0",)}})
    families = ("fast", "slow", "wide", "deep")
    write_pool(home, "others", {f"{f}-{i}": {"configuration": f, "seed": i} for f, i in product(families, range(3))})
    return home


def pretend(pools, folder, seed=0):
    """Writes played episodes in which every agent has a skill, and a place as partner, that decide the returns."""
    rng = np.random.default_rng(seed)
    players = {p.sha256: p for pool in pools for p in players_of(pool, LAYOUT)}
    players |= {p.sha256: p for p in (Player.scripted(name, LAYOUT) for name in SCRIPTED)}
    skill = dict(zip(players, rng.uniform(20, 220, len(players)), strict=True))
    ease = dict(zip(players, rng.uniform(0.5, 1.0, len(players)), strict=True))
    pairs = list(product(players, players))
    returns = np.array([np.full((EPISODES, 2), skill[a] * ease[b]) for a, b in pairs])
    returns += rng.normal(0, 2, returns.shape)
    folder.mkdir()
    np.savez(
        folder / f"{LAYOUT}-{EPISODES}-episodes-seed-0-horizon-400.npz",
        pairs=np.array([f"{a} {b}" for a, b in pairs]),
        returns=returns,
        sides=np.zeros(returns.shape, np.int64),
    )
    return skill
