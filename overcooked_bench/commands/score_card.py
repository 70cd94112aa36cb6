"""The cooperation scenarios on a score card: played after the score, and put down as plain numbers."""

import json
from collections.abc import Callable, Sequence
from functools import partial
from hashlib import sha256
from typing import TYPE_CHECKING, Final

from overcooked_bench.estimate import t_interval
from overcooked_bench.evaluation.scores import CategoryScore, ScenarioScore, Source

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import Reference
    from overcooked_bench.evaluation.score import Scored
    from overcooked_bench.scenarios.items import Item
    from overcooked_bench.scenarios.results import SuiteResult, Tally

SCENARIOS_FILE: Final = "scenarios.json"
TOTAL: Final = "total"


def play_scenarios(
    agent: "Reference",
    scored: "Scored",
    layouts: Sequence[str] | None = None,
    on_progress: Callable[[str, int, int], None] = lambda *_: None,
) -> ScenarioScore | None:
    """Plays the shipped scenarios with an agent that was scored, and writes what came of every item beside the score.

    Args:
        agent: As it was scored.
        scored: Its score.
        layouts: Scenarios of these layouts only; all by default.
        on_progress: Called with what has just been done, how much is done, and of how much.

    Returns:
        What belongs on the score card, None where there is no scenario of these layouts.

    Raises:
        ScenarioFault: The agent broke the contract.
        AgentError: The agent has been changed since.
    """
    from overcooked_bench.agents.catalogue import find, find_unchanged
    from overcooked_bench.scenarios.items import load_items
    from overcooked_bench.scenarios.results import SuiteResult
    from overcooked_bench.scenarios.runner import REPEATS, run_items

    scores, mode = scored.scores, scored.scores.settings.play.mode
    chosen = [item for item in load_items() if layouts is None or item.scenarios[0].layout.name in layouts]
    if not chosen:
        return None
    make_agent = find_unchanged(find(agent, mode=mode).reference, scores.agent.sha256, mode).make
    results = []
    for seed in range(scores.training_seeds):
        named = f"scenarios, training seed {seed}" if scores.training_seeds > 1 else "scenarios"
        played = run_items(make_agent, chosen, training_seed=seed, on_progress=partial(on_progress, named))
        results.append(SuiteResult(scores.agent.name, mode, REPEATS, seed, 0, False, tuple(played)))
        name = SCENARIOS_FILE if scores.training_seeds == 1 else SCENARIOS_FILE.replace(".", f"-{seed}.")
        (scored.folder / name).write_text(json.dumps(results[-1].to_dict(), indent=2) + "\n", "utf-8")
    return ScenarioScore(
        suite=Source("unit_scenarios", _digest(chosen)),
        repeats=REPEATS,
        categories=tuple(_category(name, results) for name in results[0].by_category),
        total=_category(TOTAL, results),
    )


def _category(name: str, results: "Sequence[SuiteResult]") -> CategoryScore:
    """Takes the training seeds together."""
    tallies: list[Tally] = [result.total if name == TOTAL else result.by_category[name] for result in results]
    first, runs = tallies[0], len(tallies)
    share = first.score if runs == 1 else t_interval([tally.score.value for tally in tallies], 0, 1)
    return CategoryScore(
        category=name,
        items=first.n,
        passed=sum(tally.passed for tally in tallies) / runs,
        not_attempted=sum(tally.not_attempted for tally in tallies) / runs,
        families=first.families,
        share=share,
    )


def _digest(items: "Sequence[Item]") -> str:
    """Computes the hash of what is played."""
    from overcooked_bench.scenarios.solving.lock import definition

    told = {f"{scenario.id} {definition(scenario)}" for item in items for scenario in item.scenarios}
    return sha256("\n".join(sorted(told)).encode()).hexdigest()
