"""A pool: a frozen, hashed set of partners in a folder.

A pool's folder holds `manifest.json` and for each policy `<layout>/<name>.safetensors` and `<layout>/<name>.json`.
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
    policies,
    read_manifest,
)
from overcooked_bench.agents.pools.records import Entry, Manifest
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.shelf import Shelf, guess

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.policy import Policy

_SHELF: Final = Shelf(
    "pool", "overcooked_bench.baselines", f"/{MANIFEST}", PoolError, f"a folder with a {MANIFEST}", "pools"
)


@dataclass(frozen=True)
class Pool:
    """A pool whose files were verified, as `Pool.load` returns it.

    Attributes:
        folder: Its folder.
        manifest: Its manifest.
    """

    folder: Path
    manifest: Manifest
    _policies: "dict[tuple[str, str], Policy]" = field(default_factory=dict, repr=False, compare=False)

    @classmethod
    def load(cls, name_or_folder: str | Path) -> "Pool":
        """Reads a pool and verifies it: every file exists, has the hash in the manifest, and is used once.

        Args:
            name_or_folder: A shipped pool's name, or a folder.

        Raises:
            PoolError: There is no such pool, or something in it is wrong; names the agent and the file.
        """
        folder = find_pool(name_or_folder)
        manifest = read_manifest(folder)
        for entry in manifest.entries:
            check_files(folder, manifest, entry)
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
    def frozen(self) -> bool:
        """Whether it stays as it is; False for a release candidate."""
        return self.manifest.frozen

    @property
    def cooking(self) -> str:
        """The cooking mode that the pool must be played under."""
        return self.manifest.cooking

    @property
    def mode(self) -> str:
        """How policies choose their actions: "sample" or "greedy"."""
        return self.manifest.mode

    @property
    def layouts(self) -> tuple[str, ...]:
        """The layouts that have partners, in the order of `layout_names`, then grids' texts."""
        present = {entry.layout for entry in self.manifest.entries}
        shipped = tuple(name for name in layout_names() if name in present)
        return *shipped, *sorted(present - set(shipped))

    def partners(self, layout: str) -> tuple[Entry, ...]:
        """Lists the partners and floors of a layout by name; none for a layout that it does not cover."""
        return _on(layout, self.manifest.entries)

    def agents(self, layout: str) -> tuple[Entry, ...]:
        """Lists the frozen policies among the partners by name: those that a learner may train with."""
        return _on(layout, policies(self.manifest))

    def agent(self, layout: str, name: str) -> Entry:
        """Returns the entry of a frozen policy.

        Raises:
            PoolError: No such layout or agent; names the nearest.
        """
        if layout not in self.layouts:
            raise PoolError(f"pool {self.name!r} has no agents for {layout!r}; it has {', '.join(self.layouts)}")
        named = {entry.name: entry for entry in self.agents(layout)}
        if name not in named:
            raise PoolError(
                f"pool {self.name!r} has no trained agent {name!r} on {layout}; {guess(name, named)}"
                f"It has {', '.join(named) or 'none'}"
            )
        return named[name]

    def policy(self, layout: str, name: str) -> "Policy":
        """Reads one policy, once.

        Raises:
            PoolError: No such agent, or its files were changed since the pool was loaded.
            PolicyError: Its files do not fit each other.
        """
        if (layout, name) not in self._policies:
            entry = self.agent(layout, name)
            check_files(self.folder, self.manifest, entry)
            self._policies[layout, name] = check_policy(self.folder, self.manifest, entry)
        return self._policies[layout, name]


def _on(layout: str, entries: tuple[Entry, ...]) -> tuple[Entry, ...]:
    return tuple(sorted((entry for entry in entries if entry.layout == layout), key=lambda entry: entry.name))


def shipped_pools() -> tuple[str, ...]:
    """Lists the names of the pools that come with the package."""
    return _SHELF.names()


def is_pool(name_or_folder: str | Path) -> bool:
    """Returns whether this is a shipped pool's name, or a folder with a manifest."""
    return _SHELF.file(name_or_folder) is not None


def find_pool(name_or_folder: str | Path) -> Path:
    """Returns the folder of a shipped pool's name or of a folder.

    Raises:
        PoolError: No such pool; names the shipped ones.
    """
    return _SHELF.find(name_or_folder).parent
