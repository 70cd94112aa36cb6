"""Plays an agent through scenarios, all runs that share a kitchen at the same time."""

import hashlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from math import ceil
from typing import TYPE_CHECKING, Any, Final

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import AgentFactory, Reference, UnknownLayout
from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.mirror import mirrored
from overcooked_bench.agents.seated import Seated, SeatedFault, Views
from overcooked_bench.agents.submissions.checks import check_agent
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.kitchen.observations.registry import history_for
from overcooked_bench.scenarios.errors import ScenarioFault
from overcooked_bench.scenarios.items import Item, Select, load_items
from overcooked_bench.scenarios.judge import Run, replay
from overcooked_bench.scenarios.results import PASS_RATE, Failure, ItemResult, SuiteResult
from overcooked_bench.scenarios.scenario import Situation
from overcooked_bench.scenarios.solving.lock import budget_of, known_entry
from overcooked_bench.scenarios.stage import Part, Stage

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import Agent
    from overcooked_bench.agents.policies.neural import Mode

REPEATS: Final = 20
MOST_ROWS: Final = 4096
"""Kitchens in one batch."""

_PROBES: Final = 2  # runs with other seeds, after which the agent is checked for being deterministic
_ENOUGH: Final = 200  # decisions that have to be equal for an agent to be deterministic
_SEQUENCE: Final = 4  # repeats between two checks of what is decided already

_Group = tuple[str, str, bool]  # layout, cooking, mirrored


def run_scenarios(
    agent: Reference | AgentFactory,
    select: Select = None,
    repeats: int = REPEATS,
    mode: "Mode" = "sample",
    *,
    training_seed: int = 0,
    warmup: int = 0,
    sequential: bool = False,
    name: str | None = None,
) -> SuiteResult:
    """Plays an agent through scenarios and says which it passes.

    Args:
        agent: What `find` takes: a name, a path, or a behaviour mapping; or a function
            `make_agent(layout, training_seed)`.
        select: Which items; all that ship by default. An id or its beginning (`"C04"`), a category, a family, a tag, a
            pattern with `*`, the path of a file or a folder; or a list of such.
        repeats: Runs of each situation, for agents that are not deterministic.
        mode: How frozen policies act: "sample" or "greedy".
        training_seed: Which of a submission's training runs to test.
        warmup: How often agents are shown the first observation, their answers ignored, before they are asked.
        sequential: Whether to stop an item's runs once its verdict is certain; the rates are rougher then.
        name: The agent's name; by default the reference.

    Raises:
        ScenarioError: A scenario is wrong, or nothing fits `select`.
        ScenarioFault: The agent broke the contract.
        AgentError: The agent cannot be loaded.

    Example:
        ```python
        from overcooked_bench import run_scenarios

        result = run_scenarios("greedy", select="convention")
        print(result.passed, "of", result.n)
        ```
    """
    chosen = load_items(select)
    results = run_items(
        agent if callable(agent) else find(agent, mode=mode).make,
        *(chosen, repeats),
        training_seed=training_seed,
        warmup=warmup,
        sequential=sequential,
    )
    called = name or str(getattr(agent, "__name__", agent))
    return SuiteResult(called, mode, repeats, training_seed, warmup, sequential, tuple(results))


def run_items(
    make_agent: AgentFactory,
    items: Sequence[Item],
    repeats: int = REPEATS,
    *,
    training_seed: int = 0,
    warmup: int = 0,
    sequential: bool = False,
    on_progress: Callable[[int, int], None] = lambda *_: None,
) -> list[ItemResult]:
    """Plays items; see `run_scenarios`.

    Args:
        make_agent: Makes an agent for a layout's name and a training seed.
        items: The items to play.
        repeats: Runs of each situation.
        training_seed: Passed to `make_agent`.
        warmup: How often the first observation is shown before the start.
        sequential: Whether to stop an item's runs once its verdict is certain.
        on_progress: Called with the number of kitchens that are done, and the total.

    Returns:
        A result for each item, in their order.

    Raises:
        ScenarioError: A scenario cannot be solved, so that it has no budget.
        ScenarioFault: The agent broke the contract.
    """
    for name, value, least in (("repeats", repeats, 1), ("warmup", warmup, 0)):
        if value < least:
            raise ValueError(f"{name}={value!r}; give a whole number from {least}")
    groups: dict[_Group, list[Situation]] = {}
    for situation in {s.id: s for item in items for s in item.situations}.values():
        key = situation.layout.name, situation.scenario.cooking, situation.mirrored
        groups.setdefault(key, []).append(situation)
    played: dict[str, _Played] = {}
    for done, (_, situations) in enumerate(sorted(groups.items(), key=lambda entry: entry[0])):
        on_progress(done, len(groups))
        for part in _play_group(make_agent, situations, repeats, training_seed, warmup, sequential):
            played[part.part.situation.id] = part
    on_progress(len(groups), len(groups))
    return [_result(item, [played[situation.id] for situation in item.situations], repeats) for item in items]


def play_once(
    make_agent: AgentFactory, situation: Situation, repeat: int = 0, *, training_seed: int = 0, warmup: int = 0
) -> Run:
    """Plays one run as `run_items` plays it among others, and judges it.

    Args:
        make_agent: Makes an agent for a layout's name and a training seed.
        situation: The situation to play.
        repeat: Which run, from 0; determines the seed.
        training_seed: Passed to `make_agent`.
        warmup: How often the first observation is shown before the start.

    Raises:
        UnknownLayout: The agent declines the layout.
        ScenarioError: The scenario cannot be solved, so that it has no budget.
        ScenarioFault: The agent broke the contract.
    """
    part, unknown = Part(situation, budget_of(situation.scenario)), []
    seeds = np.array([scenario_seed(situation.scenario.id, repeat)], np.uint64)
    for make, _ in _ways(make_agent, situation, training_seed):
        try:
            agent = make()
            check_agent(agent, f"make_agent({situation.layout.name!r}, {training_seed})")
            with one_thread(load=False):
                stage = _perform(agent, [part], seeds, 1, warmup)
        except UnknownLayout as error:
            unknown.append(error)
            continue
        return replay(situation, part.budget, stage.actions[: part.length, 0])
    raise unknown[0]


def scenario_seed(scenario: str, repeat: int) -> int:
    """Returns A's seed in a repeat of a scenario: the same for every agent, seat and mirror.

    Args:
        scenario: The scenario's id.
        repeat: Which repeat, from 0.
    """
    digest = hashlib.sha256(f"scenario/{scenario}/{repeat}".encode()).digest()
    return int.from_bytes(digest[:8], "little")


@dataclass(eq=False)
class _Played:
    """A situation's runs so far."""

    part: Part
    passed: list[bool] = field(default_factory=list)
    actions: NDArray[np.uint8] | None = None
    failure: Failure | None = None
    deterministic: bool = False
    adapted: bool = False
    reason: str = ""

    def certain(self, repeats: int) -> bool:
        """Whether no further run can change the verdict."""
        needed = _needed(repeats)
        return sum(self.passed) >= needed or len(self.passed) - sum(self.passed) > repeats - needed


def _needed(runs: int) -> int:
    """Returns how many of a number of runs have to pass."""
    return ceil(PASS_RATE * runs - 1e-9)


def _result(item: Item, played: list[_Played], repeats: int) -> ItemResult:
    scenarios = item.scenarios
    steps = [entry.steps for scenario in scenarios if (entry := known_entry(scenario))]
    reason = next((part.reason for part in played if part.reason), "")
    facts: dict[str, Any] = {
        "item": item,
        "adapted": any(part.adapted for part in played),
        "budget": max(part.part.budget for part in played),
        "steps": max(steps) if len(steps) == len(scenarios) else None,
    }
    if reason:
        return ItemResult(status="not attempted", runs=0, passes=0, deterministic=False, reason=reason, **facts)
    worst = min(played, key=lambda part: sum(part.passed) / len(part.passed))
    deterministic = all(part.deterministic for part in played)
    wanted = 1 if worst.deterministic else repeats
    passed = sum(worst.passed) >= _needed(wanted)
    return ItemResult(
        status="passed" if passed else "failed",
        runs=len(worst.passed),
        passes=sum(worst.passed),
        deterministic=deterministic,
        failure=worst.failure,
        **facts,
    )


def _play_group(
    make_agent: AgentFactory,
    situations: list[Situation],
    repeats: int,
    training_seed: int,
    warmup: int,
    sequential: bool,
) -> list[_Played]:
    """Plays situations of one kitchen."""
    parts = [Part(situation, budget_of(situation.scenario)) for situation in situations]
    parts.sort(key=lambda part: part.length)
    layout = situations[0].layout
    reason = ""
    for make, adapted in _ways(make_agent, situations[0], training_seed):
        try:
            agent = make()
            check_agent(agent, f"make_agent({layout.name!r}, {training_seed})")
            with one_thread(load=False):
                played = _play_parts(agent, parts, repeats, warmup, sequential)
        except UnknownLayout as error:
            reason = reason or str(error) or "it does not know this kitchen"
            continue
        for one in played:
            one.adapted = adapted
        return played
    return [_Played(part, reason=reason) for part in parts]


def _play_parts(agent: "Agent", parts: Sequence[Part], repeats: int, warmup: int, sequential: bool) -> list[_Played]:
    """Plays two repeats of each part, and the others unless the agent turns out to be deterministic."""
    played = [_Played(part) for part in parts]
    first, alike, compared = 0, True, 0
    while first < repeats:
        upto = _PROBES if first == 0 else first + _SEQUENCE if sequential else repeats
        chunk = range(first, min(upto, repeats))
        going = [one for one in played if not (sequential and one.certain(repeats))]
        for some in _chunks(going, len(chunk)):
            alike &= _play(agent, some, chunk, warmup)
        compared += sum(one.part.budget for one in going) * (len(chunk) - (first == 0))
        first = chunk.stop
        if alike and compared >= _ENOUGH:
            for one in played:
                one.deterministic = True
                del one.passed[1:]
            break
    return played


def _chunks(played: Sequence[_Played], repeats: int) -> Iterator[Sequence[_Played]]:
    """Splits parts into batches of bounded size."""
    size = max(1, MOST_ROWS // repeats)
    for start in range(0, len(played), size):
        yield played[start : start + size]


def _play(agent: "Agent", played: Sequence[_Played], repeats: range, warmup: int) -> bool:
    """Plays repeats of parts and adds their results; returns whether all were equal to the first repeat."""
    parts = [one.part for one in played]
    seeds = np.array([[scenario_seed(p.situation.scenario.id, k) for k in repeats] for p in parts], np.uint64).ravel()
    stage = _perform(agent, parts, seeds, len(repeats), warmup)
    alike = True
    for index, one in enumerate(played):
        rows = slice(index * len(repeats), (index + 1) * len(repeats))
        actions = stage.actions[: one.part.length, rows]
        one.actions = actions[:, 0].copy() if one.actions is None else one.actions
        alike &= bool((actions == one.actions[:, None]).all())
        passed = stage.passed[rows].tolist()
        if one.failure is None and not all(passed):
            k = passed.index(False)
            joint = tuple((int(a), int(b)) for a, b in actions[:, k])
            one.failure = Failure(one.part.situation, one.part.budget, repeats[k], int(seeds[rows][k]), joint)
        one.passed += passed
    return alike


def _ways(make_agent: AgentFactory, situation: Situation, seed: int) -> "Iterator[tuple[Callable[[], Agent], bool]]":
    """Lists the ways to make an agent for a kitchen, each with whether the agent is adapted then.

    Args:
        make_agent: Makes it.
        situation: A situation of the kitchen.
        seed: The training seed.
    """
    layout = situation.layout
    yield lambda: make_agent(layout.name, seed), False
    if situation.mirrored:
        yield lambda: mirrored(make_agent(layout.mirrored().name, seed)), True


def _perform(agent: "Agent", parts: Sequence[Part], seeds: NDArray[np.uint64], repeats: int, warmup: int) -> Stage:
    """Plays all runs to their verdicts."""
    try:
        seated = Seated(agent, "the agent", np.arange(len(seeds)))
        stage = Stage(parts, repeats, history_for([seated.observation]))
        seated.reset(stage.kitchens.layout.name, seeds, stage.seats)
        seated.fit(stage.kitchens)
        views = Views(stage.kitchens, stage.seats)
        for time in range(-warmup, len(stage.actions)):
            if stage.over:
                break
            views.renew()
            own = seated.act(views.of(seated))
            if time >= 0:
                stage.play(own)
    except SeatedFault as fault:
        raise ScenarioFault(_where(parts, repeats, fault)) from fault
    return stage


def _where(parts: Sequence[Part], repeats: int, fault: SeatedFault) -> str:
    situation = parts[(fault.row or 0) // repeats].situation
    named = situation.id if fault.row is not None or len(parts) == 1 else f"scenarios on {situation.layout.name!r}"
    return f"{named}, {fault.when}: {fault.what}"
