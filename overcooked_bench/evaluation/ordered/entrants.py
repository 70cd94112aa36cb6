"""Who takes part in ordered cross-play: the self-play agents that all play with, and groups of agents by method."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Final

from overcooked_bench.agents.entries import load_entry, shipped_entries
from overcooked_bench.agents.pools.manifest import PoolError
from overcooked_bench.agents.pools.pool import Pool, is_pool, shipped_pools
from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.evaluation.pools.players import Player
from overcooked_bench.shelf import guess

SELF_PLAY: Final = "self-play"
"""The method of the agents that all play with, and the name of their line."""

FEWEST: Final = 3
"""Self-play agents: with two, each has a single partner, and a curve of one point."""


@dataclass(frozen=True)
class Entrant:
    """Agents that are reported together.

    Attributes:
        name: Of the line.
        agents: By layout, its independent training runs.
    """

    name: str
    agents: Mapping[str, tuple[Player, ...]]


def find_entrants(references: Sequence[str | Path], layouts: Sequence[str]) -> tuple[Entrant, list[Entrant]]:
    """Finds the self-play agents and the entrants.

    Of each training run its final agent takes part; checkpoints, floors and scripted partners of pools do not. A pool's
    agents of one method and configuration are one entrant; a scripted agent that is named is an entrant of one row.

    Args:
        references: A pool, whose self-play agents all play with and whose other agents are entrants; then more pools,
            shipped entries, and scripted agents.
        layouts: Where.

    Raises:
        PoolError: A reference is unknown or given twice, or the first one has too few self-play agents on a layout.
    """
    given = [str(reference) for reference in references]
    if twice := [name for name in given if given.count(name) > 1]:
        raise PoolError(f"{twice[0]} is given twice; name each pool, entry and scripted agent once")
    pools = {name: _pool(name) for name in given if name not in SCRIPTED}
    names = [pool.name for pool in pools.values()]
    if twice := [name for name in names if names.count(name) > 1]:
        raise PoolError(f"two pools are named {twice[0]!r}; give one of them, or rename the other in its manifest")
    first = pools.get(given[0]) or _pool(given[0])
    own = {
        layout: tuple(one for one in _finals(first, layout) if one.entry.trained.method == SELF_PLAY)
        for layout in layouts
    }
    for layout, agents in own.items():
        if len(agents) < FEWEST:
            raise PoolError(
                f"{first.name} has {len(agents)} self-play agents on {layout}, and all entrants play with these; name "
                f"first a pool that has {FEWEST} at least, such as train-v1, or give --layouts"
            )
    found = _groups(first, layouts, lambda entry: entry.trained.method != SELF_PLAY)
    for name in given[1:]:
        if name in SCRIPTED:
            found.append(Entrant(name, {layout: (Player.scripted(name, layout),) for layout in layouts}))
        else:
            found += _groups(pools[name], layouts)
    return Entrant(SELF_PLAY, own), found


def tied(one: Entry, other: Entry) -> bool:
    """Returns whether two agents are no strangers: of one lineage, the same weights, or one trained with the other."""
    trained_with = [
        set(entry.training.settings.get("partner_hashes") or ()) if entry.training else set() for entry in (one, other)
    ]
    return (
        one.lineage == other.lineage
        or one.sha256 == other.sha256
        or other.sha256 in trained_with[0]
        or one.sha256 in trained_with[1]
    )


def _pool(name: str) -> Pool:
    if name in shipped_entries():
        return load_entry(name).pool
    if is_pool(name):
        return Pool.load(name)
    known = (*shipped_pools(), *shipped_entries(), *SCRIPTED)
    raise PoolError(
        f"{name!r} is no pool, entry or scripted agent (which the first name cannot be); {guess(name, known)}name a "
        f"folder with a manifest.json, or one of {', '.join(known)}. A submission is scored instead: overcooked-bench "
        f"score {name} --protocol thesis --pool train-v1 --isolate"
    )


def _finals(pool: Pool, layout: str) -> list[Player]:
    """Lists the final agents of a layout, one for each lineage."""
    finals: dict[str, Player] = {}
    for entry in pool.agents(layout):
        if entry.trained.done == 1:
            finals.setdefault(entry.lineage, Player(f"{pool.name}/{layout}/{entry.name}", pool, entry))
    return list(finals.values())


def _groups(pool: Pool, layouts: Sequence[str], wanted: Callable[[Entry], bool] = lambda entry: True) -> list[Entrant]:
    """Groups a pool's final agents by method and configuration."""
    found: dict[tuple[str, str], dict[str, list[Player]]] = {}
    for layout in layouts:
        for player in filter(lambda player: wanted(player.entry), _finals(pool, layout)):
            key = player.entry.trained.method, player.entry.trained.configuration or ""
            found.setdefault(key, {}).setdefault(layout, []).append(player)
    return [
        Entrant(
            pool.name if len(found) == 1 else f"{pool.name}: {' '.join(filter(None, key))}",
            {layout: tuple(players) for layout, players in by_layout.items()},
        )
        for key, by_layout in sorted(found.items())
    ]
