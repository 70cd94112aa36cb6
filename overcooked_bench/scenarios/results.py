"""Results of a run of the suite: by item, by category and by family, ready for JSON."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, Final, Literal, NamedTuple

import msgspec

from overcooked_bench.estimate import Estimate, wilson
from overcooked_bench.scenarios import CATEGORIES
from overcooked_bench.scenarios.items import Item
from overcooked_bench.scenarios.judge import Run, replay
from overcooked_bench.scenarios.scenario import Situation

SCHEMA: Final = 1
"""Version of `SuiteResult.to_dict`; raise it when a key changes its meaning or is removed."""

PASS_RATE: Final = 0.8
"""The share of runs that must pass."""

Status = Literal["passed", "failed", "not attempted"]


class Failure(NamedTuple):
    """The first run of an item that failed.

    Attributes:
        situation: The situation that was played.
        budget: Steps that A had.
        repeat: Which repeat, from 0.
        seed: A's seed in it.
        actions: Joint actions by seat, `before` first, to the end of the budget.
    """

    situation: Situation
    budget: int
    repeat: int
    seed: int
    actions: tuple[tuple[int, int], ...]

    def run(self) -> Run:
        """Replays the run and judges it."""
        return replay(self.situation, self.budget, self.actions)


@dataclass(frozen=True, eq=False)
class ItemResult:
    """The result of one item.

    Attributes:
        item: The item.
        status: "passed", "failed", or "not attempted" if the agent declined the layout; that counts as failed.
        runs: Runs of each situation; 1 if the agent is deterministic, 0 if it was not attempted.
        passes: Runs that passed; for a pair, in its worst situation.
        deterministic: Whether runs with other seeds were the same, so that one is exact.
        adapted: Whether the agent was shown the mirrored kitchen mirrored back.
        budget: Steps that A had; for a pair, the greatest.
        steps: T*, if the lock file contains it; for a pair, the greatest.
        failure: The first run that failed.
        reason: Why it was not attempted, or could not be completed.
    """

    item: Item
    status: Status
    runs: int
    passes: int
    deterministic: bool
    adapted: bool
    budget: int
    steps: int | None
    failure: Failure | None = None
    reason: str = ""

    @property
    def passed(self) -> bool:
        """Whether the item was passed."""
        return self.status == "passed"

    @property
    def rate(self) -> Estimate:
        """The share of runs that passed; an interval of width 0 if the agent is deterministic."""
        if self.deterministic or not self.runs:
            return Estimate(float(self.passes), float(self.passes), float(self.passes))
        return wilson(self.passes, self.runs)

    def to_dict(self) -> dict[str, Any]:
        """Returns everything as JSON types."""
        rate, failure = self.rate, self.failure
        return {
            "id": self.item.id,
            "scenarios": [scenario.id for scenario in self.item.scenarios],
            "category": self.item.category,
            "family": self.item.family,
            "tags": list(self.item.tags),
            "layout": self.item.situations[0].layout.name,
            "cooking": self.item.situations[0].scenario.cooking,
            "seat": self.item.seat,
            "mirrored": self.item.mirrored,
            "pair": self.item.is_pair,
            "status": self.status,
            "adapted": self.adapted,
            "deterministic": self.deterministic,
            "runs": self.runs,
            "passes": self.passes,
            "rate": rate.value,
            "wilson_low": rate.low,
            "wilson_high": rate.high,
            "budget": self.budget,
            "shortest": self.steps,
            "reason": self.reason,
            "failure": failure
            and {
                "situation": failure.situation.id,
                "repeat": failure.repeat,
                "seed": failure.seed,
                "actions": [list(joint) for joint in failure.actions],
            },
        }


def faulty(item: Item, reason: str) -> ItemResult:
    """Returns the result of an item that could not be completed: failed."""
    return ItemResult(item, "failed", 0, 0, False, False, 0, None, reason=reason)


class Tally(NamedTuple):
    """The combined result of several items.

    Attributes:
        n: Number of items.
        passed: Items that were passed.
        not_attempted: Items of layouts that the agent declined; they count as failed.
        adapted: Items that were played with the mirrored kitchen mirrored back.
        score: The mean over families of the share passed, with the Wilson interval for that number of families: items
            of one family are similar, so their number says little.
        mean_rate: The mean over families of the runs' pass rates, which is less coarse.
        families: Number of families.
    """

    n: int
    passed: int
    not_attempted: int
    adapted: int
    score: Estimate
    mean_rate: float
    families: int

    def to_dict(self) -> dict[str, Any]:
        """Returns everything as JSON types."""
        return {**self._asdict(), "score": msgspec.to_builtins(self.score)}


@dataclass(frozen=True, eq=False)
class SuiteResult:
    """The result of a run of the suite.

    Attributes:
        agent: The agent's name.
        mode: How frozen policies act: "sample" or "greedy".
        repeats: Runs of each situation for agents that are not deterministic.
        training_seed: Which training run of a submission was tested.
        warmup: How often the first observation was shown before the agent was asked for the first time.
        sequential: Whether an item's runs ended once its verdict was certain.
        items: Results by item, sorted by id.
    """

    agent: str
    mode: str
    repeats: int
    training_seed: int
    warmup: int
    sequential: bool
    items: tuple[ItemResult, ...] = field(repr=False)

    @property
    def n(self) -> int:
        """Number of items."""
        return len(self.items)

    @property
    def passed(self) -> int:
        """Number of items that were passed."""
        return sum(result.passed for result in self.items)

    @cached_property
    def total(self) -> Tally:
        """The combined result of all items."""
        return tally(result.to_dict() for result in self.items)

    @cached_property
    def by_category(self) -> dict[str, Tally]:
        """The combined result of each category that was played, in the order of `CATEGORIES`."""
        return tallies("category", [result.to_dict() for result in self.items])

    @cached_property
    def by_family(self) -> dict[str, Tally]:
        """The combined result of each family."""
        return tallies("family", [result.to_dict() for result in self.items])

    def result(self, item: str) -> ItemResult:
        """Returns an item's result by its id.

        Raises:
            KeyError: There is no such item, or it was not played.
        """
        return next((result for result in self.items if result.item.id == item), None) or _missing(item)

    def to_dict(self) -> dict[str, Any]:
        """Returns everything as JSON types."""
        settings = ("agent", "mode", "repeats", "training_seed", "warmup", "sequential")
        return suite_record({key: getattr(self, key) for key in settings}, [result.to_dict() for result in self.items])


Record = Mapping[str, Any]
"""What `ItemResult.to_dict` gives."""


def tally(records: Iterable[Record]) -> Tally:
    """Combines items."""
    found = list(records)
    families: dict[str, list[Record]] = {}
    for record in found:
        families.setdefault(record["family"], []).append(record)
    shares = [sum(r["status"] == "passed" for r in group) / len(group) for group in families.values()]
    rates = [sum(r["rate"] for r in group) / len(group) for group in families.values()]
    return Tally(
        n=len(found),
        passed=sum(record["status"] == "passed" for record in found),
        not_attempted=sum(record["status"] == "not attempted" for record in found),
        adapted=sum(record["adapted"] for record in found),
        score=wilson(sum(shares), len(shares)),
        mean_rate=sum(rates) / len(rates) if rates else 0.0,
        families=len(families),
    )


def tallies(key: Literal["category", "family"], records: Iterable[Record]) -> dict[str, Tally]:
    """Combines the items of each category or family; categories in the order of `CATEGORIES`."""
    groups: dict[str, list[Record]] = {}
    for record in records:
        groups.setdefault(record[key], []).append(record)
    order = CATEGORIES if key == "category" else sorted(groups)
    return {name: tally(groups[name]) for name in order if name in groups}


def suite_record(settings: Mapping[str, Any], records: Sequence[Record]) -> dict[str, Any]:
    """Returns a run of the suite as JSON types.

    Args:
        settings: The settings of the run: agent, mode, repeats and so on.
        records: The items' records, by id.
    """
    from importlib.metadata import version

    return {
        "schema": SCHEMA,
        "package": f"overcooked-bench {version('overcooked-bench')}",
        **settings,
        "pass_rate": PASS_RATE,
        "n": len(records),
        "passed": sum(record["status"] == "passed" for record in records),
        "total": tally(records).to_dict(),
        "by_category": {name: found.to_dict() for name, found in tallies("category", records).items()},
        "by_family": {name: found.to_dict() for name, found in tallies("family", records).items()},
        "items": list(records),
    }


def _missing(item: str) -> ItemResult:
    raise KeyError(f"no item {item!r} was played")
