"""The checks that play: partners and the agent are asked again, and some cells are played again.

Without the agent only partners are asked. The agent's code runs where `score` would run it.
"""

import platform
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib.metadata import PackageNotFoundError, version
from typing import TYPE_CHECKING, Final, NamedTuple

import msgspec

from overcooked_bench.agents.catalogue import find, runs_code
from overcooked_bench.agents.isolation.settings import isolate as isolated
from overcooked_bench.agents.kinds import Entrant
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.evaluation.games.asking import Answer, ask_block, identify
from overcooked_bench.evaluation.games.block import Block, Outcome, play_block
from overcooked_bench.evaluation.games.engines import Engine, open_engine
from overcooked_bench.evaluation.games.episode import BlockKey, Episode
from overcooked_bench.evaluation.games.facts import read_facts
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.protocol import Protocol
from overcooked_bench.evaluation.scenario_scores import play_scenarios
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.leaderboard.audit import flags
from overcooked_bench.leaderboard.audit.again import LEVEL, Compared, batches, compare, draw, recorded
from overcooked_bench.leaderboard.audit.fed import LEAST_AGREEMENT, Fed, Feeding, feed_agent, feed_partners
from overcooked_bench.leaderboard.audit.numbers import unlike
from overcooked_bench.leaderboard.audit.records import Check, Flag

if TYPE_CHECKING:
    from overcooked_bench.agents.isolation.settings import How, Isolation

PARTNERS: Final = "partners act as recorded"
AGENT: Final = "the agent"
ACTS: Final = "the agent acts as recorded"
AGAIN: Final = "cells played again"
SCENARIOS: Final = "scenarios"
_ALONE: Final = 4
"""Cells in which the agent is asked in batches of one."""
_TOGETHER: Final = 32
"""Cells in which it is asked in one batch in reverse order."""


@dataclass(frozen=True)
class Wanted:
    """How to play.

    Attributes:
        agent: The scored agent, as `score` takes it; None if it is not there.
        everything: Whether all cells are played again.
        isolate: As for `score`.
        act_timeout: As for `score`.
        workers: Number of processes.
        seed: What cells are drawn with.
    """

    agent: str | None
    everything: bool
    isolate: "How | None"
    act_timeout: float
    workers: int
    seed: int


class PlayChecks(NamedTuple):
    """What came of playing.

    Attributes:
        checks: What was looked at.
        flags: What is unusual.
        played: Number of cells that were played again.
    """

    checks: tuple[Check, ...]
    flags: tuple[Flag, ...]
    played: int


def play_checks(store: Store, scores: Scores, rules: Protocol, pool: Pool, wanted: Wanted) -> PlayChecks:
    """Asks and plays again.

    Args:
        store: The episodes, whose cells and checksums are in order.
        scores: The score.json, which agrees with the store.
        rules: Its protocol.
        pool: Its pool.
        wanted: How.

    Raises:
        AgentError: The agent cannot be loaded.
        IsolationError: It cannot be isolated as it should be.
    """
    facts = read_facts(store)
    first = Block(
        agent="",
        agent_sha256=facts.agent,
        protocol=rules,
        salt=facts.salt,
        pool=str(pool.folder.absolute()),
        pool_sha256=pool.hash,
        seed=scores.seed,
        layout=rules.play.layouts[0],
        training_seed=0,
        episodes=(0,),
    )
    whole = batches(store, first, scores.training_seeds)
    drawn = draw(whole, wanted.seed, wanted.everything)
    found = recorded(store, [key for block in drawn for key in block.keys])
    checks = [_partners(drawn, found)]
    some = flags.one_of_each(whole)
    seen = recorded(store, [block.keys[0] for block in some])
    flagged = [
        flag
        for block in some
        for similar in (flags.similar_partners, flags.similar_entries)
        for flag in similar(block, seen[block.keys[0]])
    ]
    if wanted.agent is None:
        absent = "the agent was not given"
        checks += [Check(name, "not checked", absent) for name in (AGENT, ACTS, AGAIN)]
        checks.append(_unplayed_scenarios(scores, absent))
        return PlayChecks(tuple(checks), tuple(flagged), 0)
    untrusted = runs_code(wanted.agent)
    isolation = isolated(wanted.isolate, wanted.act_timeout) if wanted.isolate and untrusted else None
    patience = wanted.act_timeout if isolation is None else None
    with open_engine("local", wanted.workers, apart=untrusted) as engine:
        entrant = _identify(wanted.agent, rules, engine, patience, isolation)
        own = [replace(block, agent=entrant.reference, isolation=isolation) for block in drawn]
        declined = [
            replace(first, agent=entrant.reference, isolation=isolation, layout=one.layout) for one in scores.declined
        ]
        checks.append(_agent(entrant, scores, declined, engine, patience))
        if checks[-1].verdict == "failed":
            other = "the agent is another one"
            checks += [Check(name, "not checked", other) for name in (ACTS, AGAIN)]
            checks.append(_unplayed_scenarios(scores, other))
            return PlayChecks(tuple(checks), tuple(flagged), 0)
        checks.append(_acts(own, found, engine, patience))
        outcomes = list(engine.map(play_block, own, _lost, patience))
        compared = compare(outcomes, found)
        checks.append(_again(compared, _same_machine(scores)))
        checks.append(_scenarios(entrant, scores, rules, engine, patience, isolation))
    return PlayChecks(tuple(checks), tuple(flagged), compared.cells)


def _identify(
    agent: str, rules: Protocol, engine: Engine, patience: float | None, isolation: "Isolation | None"
) -> Entrant:
    def lost(_: object, why: str) -> Entrant:
        raise AgentError(f"{agent}: {why}")

    if not runs_code(agent):
        return find(agent, mode=rules.play.mode)
    (entrant,) = engine.map(identify, [(agent, rules.play.mode, isolation)], lost, patience)
    return entrant


def _agent(
    entrant: Entrant, scores: Scores, declined: Sequence[Block], engine: Engine, patience: float | None
) -> Check:
    problems = []
    if entrant.sha256 != scores.agent.sha256:
        problems.append(f"the agent given has the hash {entrant.sha256}, the scored one {scores.agent.sha256}")
    if entrant.training_seeds != scores.training_seeds:
        problems.append(f"it has {entrant.training_seeds} training seeds, the result {scores.training_seeds}")
    if not problems:
        elsewhere = [block for block in declined if entrant.layout in (None, block.layout)]
        answers = engine.map(ask_block, elsewhere, lambda block, why: Answer(block.layout, fault=why), patience)
        problems += [
            f"{one.layout}: it plays there, though the result says declined" for one in answers if one.declined is None
        ]
    return _verdict(AGENT, "its hash, its training seeds and what it declines", problems)


def _partners(drawn: Sequence[Block], found: Mapping[BlockKey, list[Episode]]) -> Check:
    fed = [feed_partners(block, [one for key in block.keys for one in found[key]]) for block in drawn]
    said, low = _agreement(fed)
    cells = sum(len(found[key]) for block in drawn for key in block.keys)
    return _verdict(PARTNERS, f"{said}, {cells} cells drawn", [f"only {said}"] if low else [])


def _acts(
    own: Sequence[Block], found: Mapping[BlockKey, list[Episode]], engine: Engine, patience: float | None
) -> Check:
    tasks = []
    for block in own[:_ALONE]:
        cells = [one for key in block.keys for one in found[key]]
        tasks.append(Feeding(block, tuple(cells[:1])))
        tasks.append(Feeding(block, tuple(cells[::-1][:_TOGETHER])))
    fed = list(engine.map(feed_agent, tasks, _silent, patience))
    said, low = _agreement(fed)
    problems = [one.fault for one in fed if one.fault] or ([f"only {said}"] if low else [])
    return _verdict(ACTS, f"{said}, in batches of one and in reverse order", problems)


def _agreement(fed: Sequence[Fed]) -> tuple[str, bool]:
    """Returns in words how often they act as recorded, and whether that is too seldom."""
    same, steps = sum(one.same for one in fed), sum(one.steps for one in fed)
    share = same / steps if steps else 0.0
    return f"in {share:.2%} of {steps:,} steps", share < LEAST_AGREEMENT


def _again(compared: Compared, same_machine: bool) -> Check:
    said = f"{compared.same} of {compared.cells} cells are equal in every action"
    if compared.same == compared.cells:
        return Check(AGAIN, "passed", said)
    if same_machine:
        return _verdict(
            AGAIN, f"{said}; same kind of machine and versions, so all should be", [f"first: {compared.first}"]
        )
    said = f"{said}; other machine or versions, so returns were compared: p = {compared.p:.3f}"
    return _verdict(AGAIN, said, [f"returns differ; first: {compared.first}"] if compared.p < LEVEL else [])


def _same_machine(scores: Scores) -> bool:
    """Returns whether the result says that it was played on this kind of machine, with these versions."""
    run = scores.run
    now = {}
    for package in run.get("versions", {}):
        try:
            now[package] = version(package)
        except PackageNotFoundError:
            now[package] = "unknown"
    mine = platform.machine(), platform.python_version(), now
    return mine == (run.get("machine"), run.get("python"), run.get("versions", {}))


def _scenarios(
    entrant: Entrant,
    scores: Scores,
    rules: Protocol,
    engine: Engine,
    patience: float | None,
    isolation: "Isolation | None",
) -> Check:
    if scores.scenarios is None:
        return _unplayed_scenarios(scores, "")
    wanted = {one.layout for one in scores.layouts} | {one.layout for one in scores.declined}
    layouts = None if wanted >= set(rules.play.layouts) else sorted(wanted)
    played = play_scenarios(entrant, rules.play.mode, layouts, engine, patience, lambda *_: None, isolation)
    now = msgspec.to_builtins(played.score) if played else None
    problems = list(unlike("scenarios", msgspec.to_builtins(scores.scenarios), now))
    return _verdict(SCENARIOS, "all of them played again", problems)


def _unplayed_scenarios(scores: Scores, why: str) -> Check:
    return Check(SCENARIOS, "not checked", why if scores.scenarios else "the result has none")


def _lost(block: Block, why: str) -> Outcome:
    return Outcome(block, fault=f"{block.cell}: {why}")


def _silent(feeding: Feeding, why: str) -> Fed:
    return Fed(0, len(feeding.episodes) * feeding.block.protocol.play.horizon, f"{feeding.block.cell}: {why}")


def _verdict(name: str, said: str, problems: Sequence[str]) -> Check:
    return Check(name, "failed" if problems else "passed", said, tuple(problems))
