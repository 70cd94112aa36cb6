"""The configuration of a pool: `configs/pools/<name>.yaml`, groups of training runs and which of their agents enter.

Every agent of the pool follows from the file, and from the salt of a build: its name, its layout, its training seed and
all settings. With quotas, the runs' agents are candidates, and the pool is chosen among them.
"""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Final, Literal

import msgspec

from overcooked_bench.agents.pools.pool import shipped_pools
from overcooked_bench.agents.pools.records import Entry
from overcooked_bench.documents import LONGEST, Document, parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import check_name, read_text
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.shelf import Shelf

from ..learning.settings import Settings
from ..presets import PresetError, config_names, load_config
from ..running.seeds import derive_seed
from .groups import Group, Kind, ScriptedPartner

FURTHER: Final = 8
"""Most runs of a group on a layout beyond its count, where a quota lacks candidates."""


class PoolConfigError(WrongUse):
    """A pool's configuration cannot be found or read, or asks for what there is not; names the file and the key."""


_SHELF: Final = Shelf(
    "pool configuration", "overcooked_bench.baselines", ".yaml", PoolConfigError, "a YAML file", "configs/pools"
)


class PoolConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A pool to be built.

    Attributes:
        name: The pool's name.
        namespace: What seeds are derived in; no other pool's. By default the pool's name.
        layouts: Shipped layouts.
        groups: What is trained on each of them.
        cooking: Cooking mode of all agents.
        scripted: Partners beside the trained ones.
        quotas: How many candidates of each quota are chosen on each layout; none if all agents enter the pool.
        quotas_by_layout: Other numbers on single layouts.
        responders: Pools whose agents are tried as responders, beside scripted agents and the pool's own ones, to find
            what can be reached with a partner.
    """

    name: str
    namespace: str
    layouts: tuple[str, ...]
    groups: tuple[Group, ...]
    cooking: Literal["auto", "manual"] = "auto"
    scripted: tuple[ScriptedPartner, ...] = ()
    quotas: dict[str, int] = {}
    quotas_by_layout: dict[str, dict[str, int]] = {}
    responders: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        strange = sorted(
            {*self.layouts, *self.quotas_by_layout, *(name for group in self.groups for name in _layouts_of(group))}
            - {*layout_names()}
        )
        if strange or not self.layouts or len(set(self.layouts)) < len(self.layouts):
            raise ValueError(
                f"layouts is {[*self.layouts, *strange]}; choose among {', '.join(layout_names())}, each once"
            )
        if strange := sorted({*self.responders} - {*shipped_pools()}):
            raise ValueError(f"responders has {strange[0]!r}; choose among {', '.join(shipped_pools())}")
        if not self.groups:
            raise ValueError("groups is []; give one at least")
        for one, other in combinations(self.groups, 2):
            if one.prefix == other.prefix:
                raise ValueError(f"two groups have the prefix {one.prefix!r}; give each its own")
            overlap = max(one.first, other.first) < min(one.first + one.most, other.first + other.most)
            if one.method == other.method and overlap:
                raise ValueError(
                    f"groups {one.prefix} and {other.prefix} would use the same seeds of {one.method}; write "
                    f"first: {one.first + one.most} in {other.prefix}"
                )
        self._check_quotas()

    def _check_quotas(self) -> None:
        asked = [(group.prefix, group.quota) for group in self.groups]
        asked += [(one.name, one.quota) for one in self.scripted if one.quota or (self.quotas and one.role != "floor")]
        for name, quota in asked:
            if quota not in self.quotas and (quota or self.quotas):
                raise ValueError(
                    f"quotas has no {quota!r}, which {name} is a candidate for; "
                    f"it has {', '.join(self.quotas) or 'none'}"
                )
        for quota, number in self.quotas.items():
            if number < 1 or quota not in {asked_for for _, asked_for in asked}:
                raise ValueError(f"quotas has {quota}: {number}; give a number from 1, and groups with this quota")
        for layout, other in self.quotas_by_layout.items():
            for quota, number in other.items():
                if number < 0 or quota not in self.quotas:
                    raise ValueError(
                        f"quotas_by_layout, {layout}, has {quota}: {number}; give a number from 0 for one of "
                        f"{', '.join(self.quotas) or 'none'}"
                    )

    def quotas_on(self, layout: str) -> dict[str, int]:
        """Returns how many candidates of each quota are chosen on a layout."""
        return {**self.quotas, **self.quotas_by_layout.get(layout, {})}

    @property
    def trained(self) -> str:
        """The name of the pool that finished runs enter: this one, or that of its candidates."""
        return f"{self.name}-candidates" if self.quotas else self.name

    def scripted_entries(self, layouts: Iterable[str]) -> list[Entry]:
        """Lists the entries of the scripted partners that stand beside the trained ones on some layouts."""
        beside = () if self.quotas else self.scripted
        return [partner.entry(layout) for layout in sorted(layouts) for partner in beside]

    def runs(self) -> "list[Run]":
        """Lists all training runs: the first of each group on every layout, then the second, and so on."""
        most = max(group.most for group in self.groups)
        return [
            Run(self, group, layout, index)
            for index in range(most)
            for group in self.groups
            for layout in self.layouts
            if index < group.runs_on(layout)
        ]

    @property
    def all_runs(self) -> "list[Run]":
        """All runs that there can be: those that are counted, and the further ones of all quotas."""
        return self.runs() + [
            run for place in self.layouts for quota in self.quotas for run in self.further(place, quota)
        ]

    def further(self, layout: str, quota: str) -> "list[Run]":
        """Lists the runs that are added one by one where too few candidates for a quota are fit.

        Each of its groups in turn has the next seed, up to where another group's seeds begin; a group that has no run
        on the layout is left out.
        """
        found = []
        for more in range(FURTHER):
            for group in self.groups:
                index = group.runs_on(layout) + more
                after = [other.first for other in self.groups if other.method == group.method]
                free = all(first <= group.first or group.first + index < first for first in after)
                if group.quota == quota and index > more and free:
                    found.append(Run(self, group, layout, index))
        return found


@dataclass(frozen=True)
class Run:
    """One training run of a pool.

    Attributes:
        pool: What it belongs to.
        group: And within that.
        layout: Where.
        index: Which of the group's on this layout.
    """

    pool: PoolConfig
    group: Group
    layout: str
    index: int

    @property
    def name(self) -> str:
        """The name of its first agent, which the others' names begin with."""
        return f"{self.group.prefix}-{self.index:0{len(str(self.group.most - 1))}}"

    def agent(self, kind: Kind) -> str:
        """The name of one of its agents."""
        return self.name if kind == self.group.keep[0] else f"{self.name}-{kind}"

    @property
    def path(self) -> str:
        """The run's folder, relative to the pool's runs."""
        return f"{self.layout}/{self.group.prefix}-{self.index}"

    @property
    def lineage(self) -> str:
        """The lineage that all agents of this run share, and no other agent has."""
        return f"{self.pool.namespace}/{self.layout}/{self.name}"

    @property
    def seed(self) -> int:
        """The training seed."""
        group = self.group
        return derive_seed(self.pool.namespace, self.layout, group.method, group.first + self.index)

    @property
    def configuration(self) -> str:
        """The name of the method's configuration."""
        return self.group.config or config_names(self.group.method)[0]

    @cached_property
    def settings(self) -> Settings:
        """All settings of the training.

        Raises:
            PoolConfigError: The method, the configuration or a setting is unknown or out of range.
        """
        group = self.group
        given = {**group.overrides, **group.by_layout.get(self.layout, {})}
        taken = sorted({"layout", "seed", "cooking", "snapshots"} & given.keys())
        if taken:
            raise PoolConfigError(f"pool {self.pool.name}, group {group.prefix}: {taken[0]} is no override")
        fixed = {"layout": self.layout, "cooking": self.pool.cooking, "snapshots": tuple(sorted(group.snapshots))}
        try:
            return load_config(group.method, group.config, **given, **fixed)
        except (PresetError, ValueError) as error:
            raise PoolConfigError(f"pool {self.pool.name}, group {group.prefix}: {error}") from None


def pool_config_names() -> tuple[str, ...]:
    """Lists the shipped configurations."""
    return _SHELF.names()


def load_pool_config(source: str | Path, salt: str = "") -> PoolConfig:
    """Reads a shipped configuration by name, or a YAML file, and checks the settings of every run.

    A file with `extends: NAME` has everything from the configuration NAME that it does not write itself, but its
    namespace: it makes a twin, with the same recipe and other seeds.

    Args:
        source: Name or file.
        salt: Enters the namespace of all seeds; only those who know it can train the same agents.

    Raises:
        PoolConfigError: No such name or file, or something in it or the salt is wrong.
    """
    document = _read(source)
    own = dict(document.data)
    if (base := own.pop("extends", None)) is not None:
        theirs = _read(base).data if isinstance(base, str) else {}
        if not theirs or "extends" in theirs:
            raise document.error(("extends",), "extends is to name a configuration that extends no other one")
        own = {key: value for key, value in theirs.items() if key != "namespace"} | own
    if salt:
        check_name(salt, "the salt", PoolConfigError)
    if isinstance(name := own.get("namespace", own.get("name")), str):
        own["namespace"] = f"{name}/{salt}" if salt else name
    config = replace(document, data=own).convert(PoolConfig)
    check_name(config.name, f"{source}: the key `name`", PoolConfigError)
    for group in config.groups:
        check_name(group.prefix, f"{source}: the key `prefix`", PoolConfigError)
    for run in config.runs():
        _ = run.settings
    return config


def _read(source: str | Path) -> Document:
    text = read_text(_SHELF.find(source), LONGEST, raises=PoolConfigError)
    return parse_yaml(text, str(source), PoolConfigError)


def _layouts_of(group: Group) -> set[str]:
    """Returns the layouts that a group names."""
    return {*group.by_layout, *(group.count if isinstance(group.count, dict) else ())}
