"""A pool: a frozen, hashed set of agents in a folder.

A pool's folder holds `manifest.json` and for each agent `<layout>/<name>.safetensors` and `<layout>/<name>.json`.
Neither torch nor numba is needed to read it, only to play it.
"""

from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Final

from overcooked_bench.agents.pools.manifest import (
    MANIFEST,
    PoolError,
    check_files,
    check_policy,
    read_manifest,
    write_manifest,
)
from overcooked_bench.agents.pools.records import (
    AgentRecord,
    HashedFile,
    Manifest,
    PoolAgent,
    PoolFiles,
    Profile,
    SeatProfile,
    SelfPlay,
)
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.shelf import Shelf, guess

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.policy import Policy

__all__ = [
    "AgentRecord",
    "HashedFile",
    "Manifest",
    "Pool",
    "PoolAgent",
    "PoolError",
    "PoolFiles",
    "Profile",
    "SeatProfile",
    "SelfPlay",
    "find_pool",
    "read_manifest",
    "shipped_pools",
    "write_manifest",
]


_SHELF: Final = Shelf(
    "pool", "overcooked_bench.baselines", f"/{MANIFEST}", PoolError, f"a folder with a {MANIFEST}", "pools"
)


@dataclass(frozen=True)
class Pool:
    """A pool whose files were verified; `Pool.load` gives it.

    Attributes:
        folder: Where it lies.
        manifest: What it says about itself.
    """

    folder: Path
    manifest: Manifest
    _policies: "dict[tuple[str, str], Policy]" = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def load(cls, name_or_folder: str | Path) -> "Pool":
        """Reads a pool and verifies it: every file is there, hashed as the manifest says, and used once.

        Args:
            name_or_folder: A shipped pool's name, or a folder.

        Raises:
            PoolError: There is no such pool, or something in it is wrong; names the agent and the file.
        """
        folder = find_pool(name_or_folder)
        manifest = read_manifest(folder)
        for agent in manifest.agents:
            check_files(folder, manifest, agent)
        return cls(folder, manifest)

    @property
    def name(self) -> str:
        """The pool's name."""
        return self.manifest.name

    @property
    def hash(self) -> str:
        """SHA-256 of the pool, hexadecimal."""
        return self.manifest.hash

    @property
    def cooking(self) -> str:
        """The cooking mode that the pool must be played under."""
        return self.manifest.cooking

    @property
    def mode(self) -> str:
        """How the agents' actions are chosen: "sample" or "greedy"."""
        return self.manifest.mode

    @property
    def layouts(self) -> tuple[str, ...]:
        """The layouts that have agents, in the order of `layout_names`."""
        present = {agent.layout for agent in self.manifest.agents}
        return tuple(name for name in layout_names() if name in present)

    def agents(self, layout: str) -> tuple[PoolAgent, ...]:
        """Lists a layout's agents by name; none for a layout that the pool does not cover."""
        found = (agent for agent in self.manifest.agents if agent.layout == layout)
        return tuple(sorted(found, key=lambda agent: agent.name))

    def agent(self, layout: str, name: str) -> PoolAgent:
        """Gives one entry.

        Raises:
            PoolError: No such layout or agent; names the nearest.
        """
        if layout not in self.layouts:
            raise PoolError(f"pool {self.name!r} has no agents for {layout!r}; it has {', '.join(self.layouts)}")
        named = {agent.name: agent for agent in self.agents(layout)}
        if name not in named:
            raise PoolError(
                f"pool {self.name!r} has no agent {name!r} on {layout}; {guess(name, named)}It has {', '.join(named)}"
            )
        return named[name]

    def policy(self, layout: str, name: str) -> "Policy":
        """Reads one agent's policy, once.

        Raises:
            PoolError: No such agent, or its files were changed since the pool was loaded.
            PolicyError: Its files do not fit each other.
        """
        if (layout, name) not in self._policies:
            agent = self.agent(layout, name)
            check_files(self.folder, self.manifest, agent)
            self._policies[layout, name] = check_policy(self.folder, self.manifest, agent)
        return self._policies[layout, name]


def shipped_pools() -> tuple[str, ...]:
    """Lists the names of the pools that come with the package."""
    return _SHELF.names()


def is_pool(name_or_folder: str | Path) -> bool:
    """Tells whether this is a shipped pool's name, or a folder with a manifest."""
    return _SHELF.file(name_or_folder) is not None


def find_pool(name_or_folder: str | Path) -> Path:
    """Gives the folder of a shipped pool's name or of a folder.

    Raises:
        PoolError: No such pool; names the shipped ones.
    """
    return _SHELF.find(name_or_folder).parent
