"""The agents that a person can play with on each layout, and why others cannot be chosen there."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from typing import TYPE_CHECKING, Final

from overcooked_bench.agents.agent import UnknownLayout
from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.entries import load_entry, shipped_entries
from overcooked_bench.agents.kinds import Entrant
from overcooked_bench.agents.pools.manifest import read_manifest
from overcooked_bench.agents.pools.pool import Pool, find_pool, shipped_pools
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.errors import AgentFault, WrongUse
from overcooked_bench.human.server.live import kitchen_to_play

if TYPE_CHECKING:
    from overcooked_bench.agents.isolation.settings import Isolation

GIVEN: Final = "given on the command line"
_OTHER_COOKING: Final = "trained with {} cooking; this server plays with {} (--cooking {})"


@dataclass(frozen=True)
class Offers:
    """What can be chosen on a layout.

    Attributes:
        offered: Group -> references, in the order of the page's list.
        refused: Reference or group -> why it cannot be chosen here.
    """

    offered: dict[str, list[str]] = field(default_factory=dict)
    refused: dict[str, str] = field(default_factory=dict)

    @property
    def suggested(self) -> str:
        """The partner that a page begins with: the first that was given, else `greedy`."""
        return next(iter(self.offered.get(GIVEN, ())), "greedy")

    def has(self, reference: str) -> bool:
        """Returns whether an agent can be chosen."""
        return any(reference in names for names in self.offered.values())


@dataclass(frozen=True)
class Cast:
    """Everybody whom this server knows.

    Attributes:
        given: Further agents: files, folders, or other references that the catalogue does not list.
        cooking: Cooking mode of all kitchens.
        isolation: How the code of given submissions is isolated, if it is.
    """

    given: Sequence[str] = ()
    cooking: str = "auto"
    isolation: "Isolation | None" = None

    def entrant(self, reference: str) -> Entrant:
        """Finds an agent; a given one is found once."""
        return _found(reference, self.isolation if reference in self.given else None)

    def why_not(self, reference: str, layout: str) -> str:
        """Says why an agent cannot play on a layout; nothing if it can."""
        return _misfit(reference, layout, self.cooking, self.isolation if reference in self.given else None)

    def offers(self, layout: str) -> Offers:
        """Returns what can be chosen on a layout."""
        return _offers(layout, tuple(self.given), self.cooking, self.isolation)


@lru_cache(maxsize=256)
def _found(reference: str, isolation: "Isolation | None") -> Entrant:
    return find(reference, isolation=isolation)


@lru_cache(maxsize=64)
def _offers(layout: str, given: tuple[str, ...], cooking: str, isolation: "Isolation | None") -> Offers:
    found = Offers()
    for reference in given:
        if why := _misfit(reference, layout, cooking, isolation):
            found.refused[reference] = why
        else:
            found.offered.setdefault(GIVEN, []).append(reference)
    found.offered["scripted"] = [name for name in SCRIPTED if name not in given]
    for name in shipped_entries():
        runs = load_entry(name).runs
        if layout in runs:
            found.offered.setdefault("entries", []).append(name)
        else:
            found.refused[name] = f"trained on {', '.join(runs)} only"
    for name in shipped_pools():
        pool = Pool(find_pool(name), read_manifest(find_pool(name)))
        agents = pool.agents(layout) if layout in pool.layouts else ()
        if pool.cooking != cooking:
            found.refused[f"pool {name}"] = _OTHER_COOKING.format(pool.cooking, cooking, pool.cooking)
        elif agents:
            found.offered[f"pool {name}"] = [f"{name}/{layout}/{agent.name}" for agent in agents]
        else:
            found.refused[f"pool {name}"] = f"trained on {', '.join(pool.layouts)} only"
    return found


def _misfit(reference: str, layout: str, cooking: str, isolation: "Isolation | None") -> str:
    """Says why an agent cannot play on a layout; nothing if it can."""
    from concurrent.futures import ThreadPoolExecutor

    from overcooked_bench.human.server.chefs import AgentChef

    try:
        with ThreadPoolExecutor(1) as threads:
            AgentChef(_found(reference, isolation), kitchen_to_play(layout, 1, cooking), 0, threads)
    except (UnknownLayout, WrongUse, AgentFault) as error:
        return str(error)
    return ""
