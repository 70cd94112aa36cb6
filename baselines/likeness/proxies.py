"""The human proxies of a pool, with whom each was made from."""

from collections.abc import Sequence
from typing import Final, Literal, NamedTuple

from overcooked_bench.agents.policies.policy import Policy
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.errors import WrongUse
from overcooked_bench.human.people import set_of

from ..human_proxy import METHOD

SELF_PLAY_POOL: Final = "train-v1"
SELF_PLAY_AGENTS: Final = 3


class Proxy(NamedTuple):
    """A frozen human proxy.

    Attributes:
        name: In its pool.
        pairs: The set of people that it was made from.
        stage: "clone", or "regularised" if it was trained further.
        run: Equal for the two stages of one run.
        drawn: The pairs that it learned from, with repetitions.
        held_out: The other pairs of the set; they decided when cloning stopped, and the coefficient.
        coefficient: Weight of the divergence from the clone.
        policy: What plays.
    """

    name: str
    pairs: Literal["A", "B"]
    stage: Literal["clone", "regularised"]
    run: str
    drawn: tuple[str, ...]
    held_out: tuple[str, ...]
    coefficient: float
    policy: Policy


def proxies_of(pool: Pool, layout: str, games_sha256: str) -> list[Proxy]:
    """Lists the human proxies of a pool on a layout.

    Args:
        pool: Agents of other methods in it are left out.
        layout: Where they play.
        games_sha256: Hash of the games file that they are to be held against.

    Raises:
        WrongUse: A proxy was made from other games, or from people of both sets or of none.
    """
    return [_proxy(pool, entry, games_sha256) for entry in pool.agents(layout) if entry.trained.method == METHOD]


def _proxy(pool: Pool, entry: Entry, games_sha256: str) -> Proxy:
    said, which = entry.trained.settings, f"{pool.folder}: {entry.layout}/{entry.name}"
    if said["games_sha256"] != games_sha256:
        raise WrongUse(
            f"{which} was made from the games file with SHA-256 {said['games_sha256']}, the one given has "
            f"{games_sha256}; give the file that the pool was built from"
        )
    sets = {set_of(person) for person in entry.people or ()}
    if len(sets) != 1 or None in sets:
        raise WrongUse(f"{which} was made from people of {sorted(map(str, sets))}; give proxies of set A or of set B")
    (pairs,) = sets
    assert pairs is not None
    return Proxy(
        name=entry.name,
        pairs=pairs,
        stage="regularised" if said["stage"] == "regularised" and entry.trained.done == 1 else "clone",
        run=entry.lineage,
        drawn=tuple(said["drawn"]),
        held_out=tuple(said["held_out"]),
        coefficient=float(said["coefficient"]),
        policy=pool.policy(entry.layout, entry.name),
    )


def staged(proxies: Sequence[Proxy], stage: str) -> list[Proxy]:
    """Returns the proxies of one stage."""
    return [proxy for proxy in proxies if proxy.stage == stage]


def both_stages(proxies: Sequence[Proxy]) -> list[tuple[Proxy, Proxy]]:
    """Returns the regularised proxies, each behind the clone that it was before."""
    clones = {proxy.run: proxy for proxy in staged(proxies, "clone")}
    return [(clones[proxy.run], proxy) for proxy in staged(proxies, "regularised") if proxy.run in clones]


def self_play_agents(layout: str) -> list[Policy]:
    """Returns agents that learned with themselves alone, for comparison."""
    pool = Pool.load(SELF_PLAY_POOL)
    finals = [entry.name for entry in pool.agents(layout) if entry.trained.done == 1]
    return [pool.policy(layout, name) for name in finals[:SELF_PLAY_AGENTS]]
