"""The entrants that scores are compared over: agents of many recipes, none of them tied to the pool."""

from collections import defaultdict
from collections.abc import Collection, Sequence
from typing import Final

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.evaluation.pools.players import Player, players_of

MOST_OF_A_FAMILY: Final = 8
"""Entrants of one family on one layout at most, so that none of them outweighs the others."""
SCRIPTED_FAMILY: Final = "scripted"
PEOPLE_FAMILY: Final = "human proxies"
_FLOORS: Final = ("stay", "random")
_UNTRAINED: Final = "untrained"


def partners_of(pool: Pool, layout: str) -> list[Player]:
    """Lists the players of a pool on a layout that count, by stratum and name."""
    players = [player for player in players_of(pool, layout) if player.entry.role == "partner"]
    return sorted(players, key=lambda player: (player.entry.stratum, player.entry.name))


def scripted_players(layout: str) -> list[Player]:
    """Lists the scripted agents on a layout, floors included."""
    return [Player.scripted(name, layout) for name in SCRIPTED]


def recipe(player: Player) -> str:
    """Names how an entrant was made: equal for those that differ in their training seed alone."""
    entry = player.entry
    if entry.training is None:
        return entry.name
    trained = entry.training
    parts = [trained.method, trained.configuration or f"of {player.pool.name}" if player.pool else ""]
    parts += [str(trained.settings[key]) for key in ("start", "network") if trained.settings.get(key)]
    if trained.done < 1:
        parts.append("half-trained" if trained.method != "human-proxy" else "clone")
    return " ".join(parts)


def family(player: Player) -> str:
    """Names the family of an entrant, which intervals draw as a whole: one trainer and configuration.

    Start states and networks do not divide a family; half-trained agents are one of their own. All human proxies are
    one family, and all scripted agents.
    """
    entry = player.entry
    if entry.training is None:
        return SCRIPTED_FAMILY
    trained = entry.training
    if trained.method == "human-proxy":
        return PEOPLE_FAMILY
    of = trained.configuration or f"of {player.pool.name}" if player.pool else ""
    return f"{trained.method} {of}" + (", half-trained" if trained.done < 1 else "")


def tied(entry: Entry, partners: Collection[Entry], people: bool = True) -> bool:
    """Returns whether an entrant is tied to one of these partners.

    Ties are the same lineage, weights or script, having trained with the partner, and people whose games both were made
    from.

    Args:
        entry: The entrant.
        partners: Those that it would be scored with.
        people: Whether common people are a tie.
    """
    trained_with = set(entry.training.settings.get("partner_hashes") or ()) if entry.training else set()
    mine = set(entry.people or ()) if people else set()
    return any(
        entry.lineage == partner.lineage
        or entry.sha256 == partner.sha256
        or partner.sha256 in trained_with
        or mine & set(partner.people or ())
        for partner in partners
    )


def choose_entrants(layout: str, sources: Sequence[Pool], partners: Collection[Entry]) -> list[Player]:
    """Chooses the entrants of a layout.

    All agents of the sources and all scripted agents are candidates, except floors, untrained agents, and those of a
    partner's lineage, weights or script, or trained with one. Families choose in turn, the smallest first, up to
    `MOST_OF_A_FAMILY` in the order of the sources and of the agents' hashes; a lineage enters through one family only.

    Args:
        layout: Where.
        sources: Pools; first those whose agents are tied to the fewest of the other scores' partners.
        partners: The pool's that the entrants are scored with.
    """
    by_hash = [sorted(partners_of(pool, layout), key=lambda player: player.sha256) for pool in sources]
    candidates = [player for players in by_hash for player in players]
    candidates += [player for player in scripted_players(layout) if player.entry.name not in _FLOORS]
    families: dict[str, dict[str, Player]] = defaultdict(dict)
    for player in candidates:
        training = player.entry.training
        if (training is None or training.stratum != _UNTRAINED) and not tied(player.entry, partners, people=False):
            families[family(player)].setdefault(player.sha256, player)
    chosen: list[Player] = []
    taken: dict[str, str] = {}
    for name, members in sorted(families.items(), key=lambda item: (len(item[1]), item[0])):
        count = 0
        for player in members.values():
            if count < MOST_OF_A_FAMILY and taken.setdefault(player.entry.lineage, name) == name:
                chosen.append(player)
                count += 1
    return sorted(chosen, key=lambda player: (family(player), player.reference))
