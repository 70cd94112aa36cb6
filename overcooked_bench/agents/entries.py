"""Shipped entries: trained agents that scores are compared with, each a folder in a pool's format.

The agents of one layout are independent training runs of one method, named `<entry>-<number>`; in a score they are the
training seeds of one submission, in the order of their names.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Final

from overcooked_bench.agents.pools.manifest import MANIFEST, PoolError, read_manifest
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.shelf import Shelf

_SHELF: Final = Shelf(
    "entry", "overcooked_bench.baselines", f"/{MANIFEST}", PoolError, f"a folder with a {MANIFEST}", "entries"
)


@dataclass(frozen=True)
class ShippedEntry:
    """A shipped entry, as `load_entry` returns it.

    Attributes:
        pool: Its folder, whose agents' files are verified when they are read.
        runs: By layout, its independent training runs.
    """

    pool: Pool
    runs: Mapping[str, tuple[Entry, ...]]

    @property
    def training_seeds(self) -> int:
        """The number of independent training runs, the same on every layout."""
        return len(next(iter(self.runs.values())))


def shipped_entries() -> tuple[str, ...]:
    """Lists the names of the entries that come with the package."""
    return _SHELF.names()


def load_entry(name: str) -> ShippedEntry:
    """Reads a shipped entry's manifest.

    Raises:
        PoolError: There is no such entry, its manifest is damaged, or its layouts have different numbers of agents.
    """
    folder = _SHELF.find(name).parent
    pool = Pool(folder, read_manifest(folder))
    runs = {layout: pool.agents(layout) for layout in pool.layouts}
    if len(counts := {len(agents) for agents in runs.values()}) > 1 or 0 in counts:
        counted = ", ".join(f"{layout} {len(agents)}" for layout, agents in runs.items())
        raise PoolError(f"{folder}: an entry has as many trained agents on each of its layouts, this one: {counted}")
    return ShippedEntry(pool, runs)
