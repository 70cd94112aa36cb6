"""Acceptance checks of scenarios: solvable, fair and non-trivial."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Final

from overcooked_bench.agents.agent import AgentFactory
from overcooked_bench.agents.behaviours.behaviour import ScriptAgent
from overcooked_bench.agents.behaviours.parsing import parse_behaviour
from overcooked_bench.agents.scripted import SCRIPTED
from overcooked_bench.scenarios.errors import ScenarioError
from overcooked_bench.scenarios.items import HALVES, Item
from overcooked_bench.scenarios.judge import judge
from overcooked_bench.scenarios.results import PASS_RATE
from overcooked_bench.scenarios.runner import REPEATS, run_items
from overcooked_bench.scenarios.scenario import Scenario
from overcooked_bench.scenarios.solving.lock import (
    LOCK_FILE,
    Entry,
    definition,
    entry_of,
    lock_path,
    read_lock,
    situations,
    solve_scenario,
)
from overcooked_bench.scenarios.solving.oracle import play_honestly
from overcooked_bench.scenarios.solving.pairs import pair_faults

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import Agent

MOST_RANDOM: Final = 0.35
"""Greatest pass rate of a uniformly random player."""

MEAN_RANDOM: Final = 0.03
"""Its greatest average pass rate over a suite."""

HONEST: Final = 0.95
"""Least pass rate of the honest planner."""

LOOSEST: Final = 4
"""Greatest budget, as a multiple of the shortest solution."""

RANDOM_RUNS: Final = 400
SITUATIONS: Final = 4
"""Both seats, plain and mirrored."""

SANITY: Final = "sanity"
"""The tag of scenarios that both rigid cooks pass."""

_SCRIPTED: Final = ("greedy", "onion_courier", "dish_courier")
_COOKS: Final = {
    "push": parse_behaviour({"does": "helper", "insist": True}),
    "wait": parse_behaviour({"does": "helper"}),
}


def _scripted(name: str) -> AgentFactory:
    return lambda layout, seed: SCRIPTED[name].factory(layout)


def _cook(name: str) -> AgentFactory:
    def make(layout: str, seed: int) -> "Agent":
        return ScriptAgent(_COOKS[name])

    return make


PLAYERS: Final[Mapping[str, AgentFactory]] = {
    **{name: _scripted(name) for name in _SCRIPTED},
    **{name: _cook(name) for name in _COOKS},
}
"""Agents that ship and play every kitchen: the scripted agents, and two rigid cooks that do all the work themselves,
never put anything down, and walk as if B were not there ("push") or around B ("wait")."""


@dataclass(frozen=True, eq=False)
class GateReport:
    """The result of the acceptance checks for one scenario.

    Attributes:
        scenario: The scenario.
        faults: Failed checks, one sentence each; empty if it may be merged.
        entry: Its shortest solutions, None if it has none.
        random: The pass rate of a uniformly random player, the highest of the four situations.
        mean_random: The mean of these pass rates.
        stay: Number of situations, of four, that doing nothing passes.
        players: Number of situations, of four, that each of `PLAYERS` passes.
        honest: Number of situations, of four, that the honest planner passes.
        notes: Suggestions that do not keep it from being merged.
    """

    scenario: Scenario
    faults: tuple[str, ...]
    entry: Entry | None = None
    random: float = 0.0
    mean_random: float = 0.0
    stay: int = 0
    players: Mapping[str, int] = field(default_factory=dict)
    honest: int = 0
    notes: tuple[str, ...] = ()

    @property
    def mergeable(self) -> bool:
        """Whether it passes all checks."""
        return not self.faults

    @property
    def steps(self) -> int | None:
        """T*, the length of the shortest solution; the greatest of the four situations."""
        return self.entry.steps if self.entry else None

    @property
    def budget(self) -> int | None:
        """Steps that A has."""
        return self.entry.budget if self.entry else None


def check(scenario: Scenario) -> GateReport:
    """Checks one scenario, with or without a lock file in its folder; `check_all` is for pairs."""
    return check_all([scenario])[0]


def check_all(
    scenarios: Iterable[Scenario],
    random_runs: int = RANDOM_RUNS,
    on_progress: Callable[[int, int], None] = lambda *_: None,
) -> list[GateReport]:
    """Checks scenarios, and pairs for what pairs must satisfy as well.

    Args:
        scenarios: With both halves of each pair.
        random_runs: Runs of the random player in each situation.
        on_progress: Called with the number of scenarios that are done, and the total.

    Returns:
        A report for each, in their order.
    """
    wanted, reports = list(scenarios), []
    for done, scenario in enumerate(wanted):
        on_progress(done, len(wanted))
        reports.append(_alone(scenario, random_runs))
    on_progress(len(wanted), len(wanted))
    groups: dict[str, list[GateReport]] = {}
    for report in reports:
        groups.setdefault(report.scenario.pair or f"{report.scenario.id} alone", []).append(report)
    found: list[GateReport] = []
    for group in groups.values():
        faults, notes = _of_group(group)
        found += [replace(report, faults=report.faults + faults, notes=notes) for report in group]
    return sorted(found, key=lambda report: wanted.index(report.scenario))


def _alone(scenario: Scenario, random_runs: int) -> GateReport:
    """Runs the checks that concern one scenario alone."""
    written = read_lock(lock_path(scenario)).scenarios.get(scenario.id)
    known = written if written and written.definition == definition(scenario) else None
    try:
        entry = solve_scenario(scenario) if known else entry_of(scenario)
    except ScenarioError as error:
        return GateReport(scenario, (str(error),))
    faults = []
    if known and known != entry:
        faults.append(f"{LOCK_FILE} does not agree with the search; regenerate it")
    if entry.budget > LOOSEST * entry.steps:
        faults.append(f"the budget is {entry.budget} steps for a solution of {entry.steps}; ask for less or give less")
    each = situations(scenario)
    for key, situation in each.items():
        witness = entry.witnesses[key]
        runs = [judge(situation, witness.steps, witness.own) for _ in range(2)]
        if not runs[0].passed or runs[0].actions != runs[1].actions:
            faults.append(f"the shortest solution does not pass in the kitchen from {key}, or differs when repeated")
    played = {situation.id: Item(situation.id, (situation,), scenario.family, ()) for situation in each.values()}
    random = _rates(_scripted("random"), played.values(), random_runs)
    stay = sum(_rates(_scripted("stay"), played.values(), 1))
    players = {
        name: sum(rate >= PASS_RATE for rate in _rates(make, played.values(), 1 if name in _COOKS else REPEATS))
        for name, make in PLAYERS.items()
    }
    honest = sum(play_honestly(situation, entry.budget).passed for situation in each.values())
    if stay:
        faults.append("doing nothing passes; ask for something that A has to do")
    if max(random) > MOST_RANDOM:
        faults.append(f"random play passes {max(random):.0%} of its runs, more than {MOST_RANDOM:.0%}; ask for more")
    if honest < HONEST * len(each):
        faults.append(
            f"a planner that knows only B's past passes {honest} of {len(each)}; give more time or make B clearer"
        )
    mean = sum(random) / len(random)
    return GateReport(scenario, tuple(faults), entry, max(random), mean, int(stay), players, honest)


def _rates(make: AgentFactory, played: Iterable[Item], repeats: int) -> list[float]:
    return [result.rate.value for result in run_items(make, list(played), repeats)]


def _of_group(group: Sequence[GateReport]) -> tuple[tuple[str, ...], tuple[str, ...]]:
    """Returns faults and notes of a scenario that is not in a pair, or of a pair."""
    first, faults, notes = group[0].scenario, [], []
    if any(report.entry is None for report in group):
        return (), ()
    if first.pair and len(group) != HALVES:
        faults.append(f"the pair {first.pair} has {len(group)} of its two halves here")
    elif first.pair:
        faults += pair_faults(group[0].scenario, group[1].scenario)
    elif first.category == "memory":
        faults.append("one scenario alone never asks for memory; write a pair, or choose another category")
    passes = {name: all(report.players[name] == SITUATIONS for report in group) for name in PLAYERS}
    if all(passes.values()):
        faults.append(f"{', '.join(PLAYERS)} all pass; ask for something that separates agents")
    rigid = all(passes[name] for name in _COOKS)
    if rigid and SANITY not in first.tags:
        notes.append(f"both rigid cooks pass, so it says little: `tags: [{SANITY}]`, or ask for more")
    if not rigid and SANITY in first.tags:
        faults.append(f"the tag {SANITY} is for what both rigid cooks pass, and they do not; take it out")
    return tuple(faults), tuple(notes)
