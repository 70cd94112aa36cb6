"""Explains a score: plays on from moments of its episodes, says why pairs failed, and keeps the worst moments."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from overcooked_bench.agents.agent import Reference
from overcooked_bench.agents.catalogue import runs_code
from overcooked_bench.agents.isolation.settings import How
from overcooked_bench.agents.isolation.settings import isolate as isolated
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.errors import AgentFault, WrongUse
from overcooked_bench.evaluation.explaining.casting import Task
from overcooked_bench.evaluation.explaining.moments import MOMENTS, STEPS, choose_moments
from overcooked_bench.evaluation.explaining.one_layout import Found, explain_layout
from overcooked_bench.evaluation.explaining.reasons import REASONS, REPEATS
from overcooked_bench.evaluation.explaining.records import (
    EXPLAIN_FILE,
    MOMENTS_FOLDER,
    PREFIX,
    Explanation,
    LayoutExplanation,
)
from overcooked_bench.evaluation.explaining.summary import sum_up
from overcooked_bench.evaluation.games.engines import open_engine
from overcooked_bench.evaluation.games.facts import Facts, read_facts
from overcooked_bench.evaluation.games.replayed import read_settings
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.protocol import Play
from overcooked_bench.evaluation.score import ACT_TIMEOUT
from overcooked_bench.evaluation.scores import EPISODES_FILE, Source, in_folder
from overcooked_bench.files import shown, write_whole
from overcooked_bench.scenarios import SUFFIX


class Explained(NamedTuple):
    """The result of `explain`.

    Attributes:
        explanation: The content of explain.json.
        folder: The score's folder, where the files are.
    """

    explanation: Explanation
    folder: Path


def explain(
    source: str | Path,
    agent: Reference | None = None,
    pool: str | Path | None = None,
    layouts: Sequence[str] | None = None,
    workers: int = 1,
    act_timeout: float = ACT_TIMEOUT,
    isolate: How | None = None,
    moments: int = MOMENTS,
    on_progress: Callable[[str, int, int], object] = lambda layout, done, of: None,
) -> Explained:
    """Explains a score and writes explain.json and a scenario file of each of the worst moments.

    From moments in the middle of its episodes, 100 steps are played three ways: the agent with its partner, the agent
    with a copy of itself, the partner with a copy of itself; see `reasons.reason_for`. Everything that is drawn depends
    on what was played and on the moment, so the same score is explained in the same bytes, with any number of workers.

    Args:
        source: The folder of a score, or its episodes.sqlite.
        agent: The agent that was scored; by default what the score says it is, unless that is a submission, whose code
            is run only if it is given here.
        pool: The pool that it was scored with; by default likewise.
        layouts: Only these layouts of the score.
        workers: Number of processes; layouts are shared out among them.
        act_timeout: Seconds that one call of a submission's `act` may take.
        isolate: How a submission is isolated, as for `score`.
        moments: Moments on each layout.
        on_progress: Called after each layout with its name, how many are done, and how many there are.

    Raises:
        WrongUse: There is no such score, agent, pool or layout, or they are not those of the score.
        AgentFault: The agent broke the contract.
        IsolationError: The submission cannot be isolated as it should be.

    Example:
        ```python
        from overcooked_bench.evaluation.explaining.explain import explain

        explanation, folder = explain("scores/my_agent-v1", agent="my_agent.py")
        print(explanation.total.reasons["clash"])
        ```
    """
    file = in_folder(source, EPISODES_FILE)
    with Store(file) as store:
        facts, settings = read_facts(store), read_settings(store)
        tasks = _tasks(store, facts, settings.play, agent, pool, layouts, moments)
    untrusted, most = runs_code(tasks[0].agent), max(1, min(workers, len(tasks)))
    isolation = isolated(isolate, act_timeout) if isolate and untrusted else None
    tasks = [replace(task, isolation=isolation) for task in tasks]
    patience = act_timeout if isolation is None else None
    found: dict[str, Found] = {}
    with open_engine("local", most, apart=untrusted) as engine:
        for one in engine.map(explain_layout, tasks, _lost, patience):
            found[one.explanation.layout] = one
            on_progress(one.explanation.layout, len(found), len(tasks))
    ordered = [found[layout] for layout in settings.play.layouts if layout in found]
    explanation = Explanation(
        agent=Source(tasks[0].name, tasks[0].agent_sha256),
        pool=Source(facts.pool_name or "the pool", tasks[0].pool_sha256),
        protocol=Source(settings.name, settings.sha256),
        cooking=settings.play.cooking,
        steps=STEPS,
        repeats=REPEATS,
        reasons={reason: meaning.meaning for reason, meaning in REASONS.items()},
        interval=_interval(facts.training_seeds or 1),
        layouts=tuple(one.explanation for one in ordered),
        **_together([one.explanation for one in ordered]),
    )
    _write(explanation, [one.scenarios for one in ordered], file.parent)
    return Explained(explanation, file.parent)


def _tasks(
    store: Store,
    facts: Facts,
    play: Play,
    agent: Reference | None,
    pool: str | Path | None,
    layouts: Sequence[str] | None,
    moments: int,
) -> list[Task]:
    """Returns what is to be played on each layout of a score.

    Raises:
        WrongUse: The agent is code that only the score names, the pool or a layout is not of the score, or there is no
            episode to explain.
    """
    adapted, there = store.adapted(), store.values("layout")
    named = facts.agent_given or facts.agent_name
    if agent is None and runs_code(named):
        raise WrongUse(
            f"{store.file}: it says that the agent was {shown(named)}. A score may come from anywhere, so code is run "
            f"only if you name it yourself: --agent {shown(named)}"
        )
    if strange := sorted(set(layouts or ()) - set(there)):
        raise WrongUse(f"{store.file}: no episodes on {', '.join(strange)}; choose among {', '.join(there)}")
    partners = _pool(store, facts, pool or facts.pool_given or play.pool)
    salt = f"{facts.protocol}/{facts.salt}/{facts.seed}"
    tasks = [
        Task(
            agent=_text(named if agent is None else agent),
            agent_sha256=facts.agent,
            name=facts.agent_name or "the agent",
            pool=str(partners.folder.absolute()),
            pool_sha256=partners.hash,
            mode=play.mode,
            cooking=play.cooking,
            horizon=play.horizon,
            salt=salt,
            layout=layout,
            adapted=layout in adapted,
            moments=choose_moments(list(episodes), facts.agent, play.horizon, salt, moments),
        )
        for layout, episodes in groupby(store.episodes(), key=lambda episode: episode.layout)
        if layouts is None or layout in layouts
    ]
    if not any(task.moments for task in tasks):
        raise WrongUse(f"{store.file}: no episode with a partner that counts; score the agent with some first")
    return [task for task in tasks if task.moments]


def _lost(task: Task, why: str) -> Any:
    raise AgentFault(f"{task.name} on {task.layout}: {why}")


def _together(layouts: Sequence[LayoutExplanation]) -> dict[str, Any]:
    placed = [(one.layout, moment) for one in layouts for moment in one.moments]
    strata = sorted({moment.stratum for _, moment in placed})
    return {
        "strata": {stratum: sum_up([pair for pair in placed if pair[1].stratum == stratum]) for stratum in strata},
        "total": sum_up(placed),
    }


def _pool(store: Store, facts: Facts, source: str | Path | None) -> Pool:
    """Returns the pool that was played with."""
    played = facts.pool
    if source is None or played == "none":
        raise WrongUse(f"{store.file}: it names no pool; name the one that it was played with, with --pool")
    pool = Pool.load(source)
    if pool.hash != played:
        raise WrongUse(
            f"{source}: not the pool that {store.file} was played with (SHA-256 {played[:12]}… then, {pool.hash[:12]}… "
            "here); name that one with --pool, or score again"
        )
    return pool


def _text(agent: Reference) -> str:
    """Returns a reference as a text that finds the same agent."""
    import json

    return str(agent) if isinstance(agent, str | Path) else json.dumps(dict(agent))


def _interval(training_seeds: int) -> str:
    units = "partners, or over training seeds where that is wider" if training_seeds > 1 else "partners"
    covered = "" if training_seeds > 1 else "; they say nothing about retraining"
    return f"95 % intervals over {units}, whole ones, as moments with one partner are no independent draws{covered}"


def _write(explanation: Explanation, scenarios: Sequence[dict[str, str]], folder: Path) -> None:
    """Writes the files, and removes the scenarios of an earlier explanation."""
    kept = folder / MOMENTS_FOLDER
    kept.mkdir(exist_ok=True)
    texts = {file: text for of_layout in scenarios for file, text in of_layout.items()}
    for old in kept.glob(f"{PREFIX}*{SUFFIX}"):
        if old.name not in texts:
            old.unlink()
    for file, text in texts.items():
        write_whole(kept / file, text)
    explanation.write(folder / EXPLAIN_FILE)
