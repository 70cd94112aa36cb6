"""The configuration of a pool: `configs/pools/<name>.yaml`, groups of training runs and which of their agents enter.

Every agent of the pool follows from the file: its name, its layout, its training seed and all settings.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from pathlib import Path
from typing import Any, Final, Literal, get_args

import msgspec

from overcooked_bench.agents.behaviours.parsing import VERSION, parse_behaviour
from overcooked_bench.agents.pools.records import BehaviourReference, Entry, Role, ScriptedReference
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.documents import LONGEST, parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import check_name, read_text
from overcooked_bench.kitchen.layout import layout_names
from overcooked_bench.shelf import Shelf

from ..learning.settings import Settings
from ..presets import PresetError, config_names, load_config
from ..running.seeds import derive_seed

Kind = Literal["final", "half", "early", "clone"]
FINAL: Final = "final"
"""The agent at the end of a run."""
HALF: Final = "half"
"""The snapshot whose return with itself is nearest to half of the final one's."""
EARLY: Final = "early"
"""The first snapshot."""
CLONE: Final = "clone"
"""The clone of people that a human proxy is before it is trained further."""


MOST_RUNS: Final = 1000
"""Runs of one kind on one layout."""


class PoolConfigError(WrongUse):
    """A pool's configuration cannot be found or read, or asks for what there is not; names the file and the key."""


_SHELF: Final = Shelf(
    "pool configuration", "overcooked_bench.baselines", ".yaml", PoolConfigError, "a YAML file", "configs/pools"
)


class Group(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Training runs of one kind.

    Attributes:
        prefix: Agents are named `<prefix>-<index>`, and `-<kind>` is added for all kinds but the first of `keep`.
        method: Training method.
        count: Runs on each layout.
        config: A configuration of the method, the first one by default.
        first: Index of the first seed among the method's in this namespace; groups of one method use different seeds.
        overrides: Settings that replace the configuration's.
        by_layout: The same for single layouts, on top of it.
        keep: Which agents of a run enter the pool.
        snapshots: Shares of the steps at which policies are saved for `half` and `early` to be chosen from.
    """

    prefix: str
    method: str
    count: int
    config: str = ""
    first: int = 0
    overrides: dict[str, Any] = {}
    by_layout: dict[str, dict[str, Any]] = {}
    keep: tuple[Kind, ...] = (FINAL,)
    snapshots: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        snapshots = sum(kind in (HALF, EARLY) for kind in self.keep)
        left = sorted(set(self.snapshots))[int(EARLY in self.keep) :]
        for key, value, right, wanted in (
            ("count", self.count, 1 <= self.count <= MOST_RUNS, f"a number from 1 to {MOST_RUNS:,}"),
            ("first", self.first, self.first >= 0, "a number from 0"),
            (
                "keep",
                list(self.keep),
                len(set(self.keep)) == len(self.keep) > 0,
                f"some of {', '.join(get_args(Kind))}, each once",
            ),
            ("snapshots", list(self.snapshots), len(set(self.snapshots)) >= snapshots, f"{snapshots} shares at least"),
            (
                "keep",
                list(self.keep),
                CLONE not in self.keep or self.method == "human-proxy",
                "clone to runs of human-proxy alone",
            ),
            ("snapshots", list(self.snapshots), HALF not in self.keep or any(left), "one above 0 for half to be"),
        ):
            if not right:
                raise ValueError(f"group {self.prefix}: {key} is {value!r}; give {wanted}")


class ScriptedPartner(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A partner that nobody trains, on every layout of the pool.

    Attributes:
        name: The entry's name.
        agent: Name of a scripted agent; the entry's name by default.
        behaviour: A behaviour as scenarios write it, instead of a scripted agent.
        role: "partner" counts, "floor" is shown apart.
    """

    name: str
    agent: str = ""
    behaviour: dict[str, Any] | None = None
    role: Role = "partner"

    def __post_init__(self) -> None:
        if self.behaviour is not None:
            parse_behaviour(self.behaviour)
        elif (self.agent or self.name) not in SCRIPTED:
            raise ValueError(f"no scripted agent named {self.agent or self.name!r}; there are {', '.join(SCRIPTED)}")

    def entry(self, layout: str) -> Entry:
        """Returns its entry on a layout, in the version that is played here."""
        agent = self.agent or self.name
        reference: ScriptedReference | BehaviourReference
        if self.behaviour is None:
            reference = ScriptedReference(agent=agent, version=SCRIPTED[agent].version)
        else:
            reference = BehaviourReference(behaviour=self.behaviour, version=VERSION)
        return Entry(
            name=self.name,
            layout=layout,
            reference=reference,
            role=self.role,
            stratum="scripted",
            lineage=f"scripted/{agent}",
        )


class PoolConfig(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A pool to be built.

    Attributes:
        name: The pool's name.
        namespace: What seeds are derived in; no other pool's.
        layouts: Shipped layouts.
        groups: What is trained on each of them.
        cooking: Cooking mode of all agents.
        scripted: Partners beside the trained ones.
    """

    name: str
    namespace: str
    layouts: tuple[str, ...]
    groups: tuple[Group, ...]
    cooking: Literal["auto", "manual"] = "auto"
    scripted: tuple[ScriptedPartner, ...] = ()

    def __post_init__(self) -> None:
        strange = sorted(
            {*self.layouts, *(name for group in self.groups for name in group.by_layout)} - {*layout_names()}
        )
        if strange or not self.layouts or len(set(self.layouts)) < len(self.layouts):
            raise ValueError(
                f"layouts is {[*self.layouts, *strange]}; choose among {', '.join(layout_names())}, each once"
            )
        if not self.groups:
            raise ValueError("groups is []; give one at least")
        for one, other in combinations(self.groups, 2):
            if one.prefix == other.prefix:
                raise ValueError(f"two groups have the prefix {one.prefix!r}; give each its own")
            overlap = max(one.first, other.first) < min(one.first + one.count, other.first + other.count)
            if one.method == other.method and overlap:
                raise ValueError(
                    f"groups {one.prefix} and {other.prefix} would use the same seeds of {one.method}; write "
                    f"first: {one.first + one.count} in {other.prefix}"
                )

    def scripted_entries(self, layouts: Iterable[str]) -> list[Entry]:
        """Lists the entries of the scripted partners on some layouts."""
        return [partner.entry(layout) for layout in sorted(layouts) for partner in self.scripted]

    def runs(self) -> "list[Run]":
        """Lists all training runs: the first of each group on every layout, then the second, and so on."""
        most = max(group.count for group in self.groups)
        return [
            Run(self, group, layout, index)
            for index in range(most)
            for group in self.groups
            for layout in self.layouts
            if index < group.count
        ]


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
        return f"{self.group.prefix}-{self.index:0{len(str(self.group.count - 1))}}"

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


def load_pool_config(source: str | Path) -> PoolConfig:
    """Reads a shipped configuration by name, or a YAML file, and checks the settings of every run.

    Raises:
        PoolConfigError: No such name or file, or something in it is wrong.
    """
    text = read_text(_SHELF.find(source), LONGEST, raises=PoolConfigError)
    config = parse_yaml(text, str(source), PoolConfigError).convert(PoolConfig)
    check_name(config.name, f"{source}: the key `name`", PoolConfigError)
    for group in config.groups:
        check_name(group.prefix, f"{source}: the key `prefix`", PoolConfigError)
    for run in config.runs():
        _ = run.settings
    return config
