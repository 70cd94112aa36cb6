"""The parts of a pool's configuration: groups of training runs, and scripted partners."""

from typing import Any, Final, Literal, get_args

import msgspec

from overcooked_bench.agents.behaviours.parsing import VERSION, parse_behaviour
from overcooked_bench.agents.pools.records import BehaviourReference, Entry, Role, ScriptedReference
from overcooked_bench.agents.scripted import SCRIPTED

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


class Group(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Training runs of one kind.

    Attributes:
        prefix: Agents are named `<prefix>-<index>`, and `-<kind>` is added for all kinds but the first of `keep`.
        method: Training method.
        count: Runs on each layout, or a mapping from layouts to runs; layouts that it leaves out have one.
        config: A configuration of the method, the first one by default.
        first: Index of the first seed among the method's in this namespace; groups of one method use different seeds.
        overrides: Settings that replace the configuration's.
        by_layout: The same for single layouts, on top of it.
        keep: Which agents of a run enter the pool.
        snapshots: Shares of the steps at which policies are saved for `half` and `early` to be chosen from.
        stratum: Stratum of its agents; by default it follows from how they were trained.
        quota: The quota of the pool that its agents are candidates for.
    """

    prefix: str
    method: str
    count: int | dict[str, int]
    config: str = ""
    first: int = 0
    overrides: dict[str, Any] = {}
    by_layout: dict[str, dict[str, Any]] = {}
    keep: tuple[Kind, ...] = (FINAL,)
    snapshots: tuple[float, ...] = ()
    stratum: str = ""
    quota: str = ""

    def __post_init__(self) -> None:
        least = 1 if isinstance(self.count, int) else min([1, *self.count.values()])
        snapshots = sum(kind in (HALF, EARLY) for kind in self.keep)
        left = sorted(set(self.snapshots))[int(EARLY in self.keep) :]
        for key, value, right, wanted in (
            ("count", self.count, 1 <= self.most <= MOST_RUNS, f"a number from 1 to {MOST_RUNS:,}"),
            ("count", self.count, least >= 0, "no layout less than 0"),
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
            ("keep", list(self.keep), not self.quota or len(self.keep) == 1, "one kind to candidates for a quota"),
        ):
            if not right:
                raise ValueError(f"group {self.prefix}: {key} is {value!r}; give {wanted}")

    def runs_on(self, layout: str) -> int:
        """Returns how many runs it has on a layout."""
        return self.count if isinstance(self.count, int) else self.count.get(layout, 1)

    @property
    def most(self) -> int:
        """The most runs that it has on a layout."""
        return self.count if isinstance(self.count, int) else max([1, *self.count.values()])


class ScriptedPartner(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A partner that nobody trains, on every layout of the pool.

    Attributes:
        name: The entry's name.
        agent: Name of a scripted agent; the entry's name by default.
        behaviour: A behaviour as scenarios write it, instead of a scripted agent.
        role: "partner" counts, "floor" is shown apart.
        quota: The quota of the pool that it is a candidate for; without one it is always in the pool.
    """

    name: str
    agent: str = ""
    behaviour: dict[str, Any] | None = None
    role: Role = "partner"
    quota: str = ""

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
