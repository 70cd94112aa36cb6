"""The cooperation scenarios of a score: played kitchen by kitchen, each training seed by itself, as numbers."""

import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

from overcooked_bench.agents.catalogue import find_unchanged
from overcooked_bench.agents.isolation.settings import Isolation
from overcooked_bench.agents.kinds import Entrant
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.estimate import t_interval
from overcooked_bench.evaluation.games.engines import Engine
from overcooked_bench.evaluation.playing import one_line
from overcooked_bench.evaluation.scores import (
    SCENARIOS_FILE,
    CategoryScore,
    ScenarioResult,
    ScenarioScore,
    Source,
)
from overcooked_bench.files import write_whole
from overcooked_bench.scenarios import CATEGORIES
from overcooked_bench.scenarios.errors import ScenarioFault
from overcooked_bench.scenarios.items import Item, load_items
from overcooked_bench.scenarios.results import faulty, suite_record
from overcooked_bench.scenarios.runner import REPEATS, run_items
from overcooked_bench.scenarios.solving.lock import definition

if TYPE_CHECKING:
    from overcooked_bench.agents.policies.neural import Mode

SUITE: Final = "unit_scenarios"
TOTAL: Final = "total"
PASSED: Final = "passed"
NOT_ATTEMPTED: Final = "not attempted"

Kitchen = tuple[str, str, bool]


@dataclass(frozen=True)
class _Task:
    """All items of one kitchen with one training seed; small enough to be sent anywhere.

    Attributes:
        agent: Reference of the scored agent.
        agent_sha256: Its hash.
        mode: How frozen policies act.
        training_seed: Which training run.
        kitchen: `Item.kitchen`.
        items: Ids.
        isolation: How a submission is isolated, or None.
    """

    agent: str
    agent_sha256: str
    mode: "Mode"
    training_seed: int
    kitchen: Kitchen
    items: tuple[str, ...]
    isolation: Isolation | None = None


class _Done(NamedTuple):
    """What came of a task: records of its items, and what the agent did wrong, or None."""

    training_seed: int
    records: tuple[dict[str, Any], ...]
    fault: str | None = None


class ScenariosPlayed(NamedTuple):
    """What came of the scenarios.

    Attributes:
        score: Their numbers; items in which the agent broke the contract are failed.
        faults: What it did wrong.
        records: (S,) for each training seed, the records of its items by id.
    """

    score: ScenarioScore
    faults: tuple[str, ...]
    records: tuple[tuple[dict[str, Any], ...], ...]


def play_scenarios(
    entrant: Entrant,
    mode: "Mode",
    layouts: Sequence[str] | None,
    engine: Engine,
    patience: float | None,
    on_progress: Callable[[str, int, int], object],
    isolation: Isolation | None = None,
) -> ScenariosPlayed | None:
    """Plays the shipped scenarios.

    Args:
        entrant: Who is scored.
        mode: How frozen policies act.
        layouts: Scenarios of these layouts only; all by default.
        engine: Where they are played.
        patience: Seconds that one call of a submission may take; None where it is isolated.
        on_progress: Called with what has just been done, how much is done, and of how much.
        isolation: How a submission is isolated, or None.

    Returns:
        None if there is no scenario of these layouts.
    """
    chosen = [item for item in load_items() if layouts is None or item.scenarios[0].layout.name in layouts]
    if not chosen:
        return None
    kitchens: dict[Kitchen, list[str]] = {}
    for item in chosen:
        kitchens.setdefault(item.kitchen, []).append(item.id)
    tasks = [
        _Task(entrant.reference, entrant.sha256, mode, seed, kitchen, tuple(ids), isolation)
        for seed in range(entrant.training_seeds)
        for kitchen, ids in sorted(kitchens.items())
    ]
    found: list[list[dict[str, Any]]] = [[] for _ in range(entrant.training_seeds)]
    faults: list[str] = []
    for count, done in enumerate(engine.map(_play, tasks, _lost, patience), start=1):
        found[done.training_seed] += done.records
        faults += [done.fault] if done.fault else []
        on_progress("scenarios", count, len(tasks))
    records = tuple(tuple(sorted(some, key=lambda record: str(record["id"]))) for some in found)
    return ScenariosPlayed(profile(records), tuple(sorted(map(one_line, faults))), records)


def profile(records: Sequence[Sequence[Mapping[str, Any]]]) -> ScenarioScore:
    """Computes what was passed: of each scenario, of each category, and in total.

    Args:
        records: (S,) for each training seed, the records of its items, as `ItemResult.to_dict` returns them.
    """
    by_seed = [_shares(some) for some in records]
    results = tuple(
        ScenarioResult(name, category, _mean([shares[name, category] for shares in by_seed]))
        for name, category in by_seed[0]
    )
    names = [name for name in CATEGORIES if any(one.category == name for one in results)]
    return ScenarioScore(
        suite=Source(SUITE, suite_sha256()),
        repeats=REPEATS,
        categories=tuple(_category(name, by_seed) for name in names),
        total=_category(TOTAL, by_seed),
        scenarios=results,
    )


_Shares = dict[tuple[str, str], float | None]
"""(scenario, category) -> the share of its situations that a training seed passed; None if it attempted none."""


def _shares(records: Iterable[Mapping[str, Any]]) -> _Shares:
    """Returns what one training seed passed; a mirror image that was turned back for it is no further situation."""
    found: dict[tuple[str, str], list[str]] = {}
    for record in records:
        one = record["scenarios"][0] if len(record["scenarios"]) == 1 else record["id"]
        statuses = found.setdefault((one, record["category"]), [])
        if not (record["mirrored"] and record["adapted"]):
            statuses.append(record["status"])
    tried = {key: [status for status in some if status != NOT_ATTEMPTED] for key, some in sorted(found.items())}
    return {key: some.count(PASSED) / len(some) if some else None for key, some in tried.items()}


def _mean(shares: Sequence[float | None]) -> float | None:
    known = [share for share in shares if share is not None]
    return sum(known) / len(known) if known else None


@cache
def suite_sha256() -> str:
    """Computes the hash of the shipped scenarios."""
    definitions = {f"{scenario.id} {definition(scenario)}" for item in load_items() for scenario in item.scenarios}
    return sha256("\n".join(sorted(definitions)).encode()).hexdigest()


def write_scenarios(played: ScenariosPlayed, agent: str, mode: str, folder: Path) -> None:
    """Writes what came of every item: scenarios.json, or one file per training seed if there are several."""
    for seed, records in enumerate(played.records):
        name = SCENARIOS_FILE if len(played.records) == 1 else SCENARIOS_FILE.replace(".", f"-{seed}.")
        settings = {"agent": agent, "mode": mode, "repeats": REPEATS, "training_seed": seed}
        content = suite_record({**settings, "warmup": 0, "sequential": False}, records)
        write_whole(folder / name, json.dumps(content, indent=2) + "\n")


@cache
def _by_id() -> Mapping[str, Item]:
    return {item.id: item for item in load_items()}


def _play(task: _Task) -> _Done:
    """Plays a task; a fault of the agent comes back, so that no other task is lost with it."""
    chosen = [_by_id()[name] for name in task.items]
    try:
        make_agent = find_unchanged(task.agent, task.agent_sha256, task.mode, task.isolation).make
        played = run_items(make_agent, chosen, training_seed=task.training_seed)
    except (ScenarioFault, AgentError) as fault:
        return _lost(task, str(fault))
    return _Done(task.training_seed, tuple(result.to_dict() for result in played))


def _lost(task: _Task, why: str) -> _Done:
    """Fails all items of a task: the agent broke the contract, or its process died or was overdue."""
    records = tuple(faulty(_by_id()[name], why).to_dict() for name in task.items)
    layout, _, mirrored = task.kitchen
    where = f"scenarios on {'its own layout' if chr(10) in layout else layout}{' (mirrored)' if mirrored else ''}"
    return _Done(task.training_seed, records, f"{where}, training seed {task.training_seed}: {why}")


def _category(name: str, by_seed: Sequence[_Shares]) -> CategoryScore:
    """Combines the training seeds. Scenarios are designed and not drawn, so one training run has no interval."""
    own = [[share for (_, category), share in some.items() if name in (category, TOTAL)] for some in by_seed]
    tried = [[share for share in some if share is not None] for some in own]
    runs = len(by_seed)
    shares = [sum(some) / len(some) for some in tried if some]
    return CategoryScore(
        category=name,
        attempted=sum(map(len, tried)) / runs,
        passed=sum(map(sum, tried)) / runs,
        not_attempted=sum(len(some) - len(left) for some, left in zip(own, tried, strict=True)) / runs,
        share=t_interval(shares, 0, 1) if shares else None,
    )
