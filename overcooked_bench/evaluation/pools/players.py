"""Players: entries of any pools, and scripted agents, that are to be played with one another on one layout."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

from overcooked_bench.agents.pools.manifest import check_version
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Entry, ScriptedReference
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.errors import WrongUse


@dataclass(frozen=True)
class Player:
    """Somebody who plays: an entry of a pool, or a scripted agent without one.

    Attributes:
        reference: What results call it, such as "train-v1/coordination_ring/sp-03".
        pool: Where it comes from; None for a scripted agent of the catalogue.
        entry: What the pool says about it.
    """

    reference: str
    pool: Pool | None
    entry: Entry

    @classmethod
    def scripted(cls, name: str, layout: str) -> "Player":
        """Makes a player of a scripted agent of the catalogue, such as "greedy"."""
        reference = ScriptedReference(agent=name, version=SCRIPTED[name].version)
        lineage = f"scripted/{name}"
        entry = Entry(
            name=name, layout=layout, reference=reference, role="partner", stratum="scripted", lineage=lineage
        )
        return cls(name, None, entry)

    @property
    def sha256(self) -> str:
        """Hash of what plays."""
        return self.entry.sha256


def players_of(pool: Pool, layout: str) -> list[Player]:
    """Lists the players of a pool on a layout by name, floors included."""
    return [Player(f"{pool.name}/{layout}/{entry.name}", pool, entry) for entry in pool.partners(layout)]


def common_cooking(layout: str, players: Sequence[Player]) -> Literal["auto", "manual"]:
    """Returns the cooking mode of the players' pools, "auto" if none is of a pool.

    Raises:
        WrongUse: A player is of another layout, or the pools differ in their cooking mode.
        PoolError: A scripted player has another version here than its pool means.
    """
    modes: dict[str, str] = {}
    for player in players:
        if player.entry.layout != layout:
            raise WrongUse(f"{player.reference} plays {player.entry.layout!r}; give players of {layout!r}")
        if player.pool is not None:
            check_version(player.pool.manifest, player.entry)
            modes[player.pool.cooking] = player.reference
    if len(modes) > 1:
        said = " and ".join(f"{reference} {mode!r}" for mode, reference in sorted(modes.items()))
        raise WrongUse(f"the players' pools differ in their cooking mode ({said}); give players of one mode")
    return "manual" if "manual" in modes else "auto"
