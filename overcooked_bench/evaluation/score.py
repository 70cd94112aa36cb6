"""The main job: plays an agent with every partner of a protocol and writes down what came of it."""

import platform
import time
from collections.abc import Callable, Sequence
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from itertools import takewhile
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from overcooked_bench.agents.agent import Reference
from overcooked_bench.agents.catalogue import find
from overcooked_bench.agents.kinds import RUNS_CODE, Entrant
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.errors import AgentFault
from overcooked_bench.evaluation.games.block import Block, Outcome, play_block
from overcooked_bench.evaluation.games.engines import Engine, open_engine
from overcooked_bench.evaluation.games.replayed import check_returns
from overcooked_bench.evaluation.games.roster import check_pool
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.games.streams import FRESH, draw_salt
from overcooked_bench.evaluation.protocol import NEWEST, Protocol, ProtocolError, is_text, load_protocol
from overcooked_bench.evaluation.scores import SCHEMA, ScenarioScore, Scores, Source
from overcooked_bench.evaluation.shown.plots import draw_curve
from overcooked_bench.evaluation.shown.report import write_report
from overcooked_bench.evaluation.summary import compute_layouts, describe_interval
from overcooked_bench.kitchen.layout import Layout

EPISODES_FILE: Final = "episodes.sqlite"
SCORES_FILE: Final = "score.json"
CURVE_FILE: Final = "curve.png"
REPORT_FILE: Final = "report.html"

ACT_TIMEOUT: Final = 60.0

_PACKAGES: Final = ("overcooked-bench", "numpy", "numba", "torch")


class ScoringFault(AgentFault):
    """The scored agent broke the contract; the blocks that were played before are in the store."""


class Scored(NamedTuple):
    """What `score` gives.

    Attributes:
        scores: The content of score.json.
        folder: Where the files are.
    """

    scores: Scores
    folder: Path


class Progress(NamedTuple):
    """How far a score is.

    Attributes:
        layout: Of the block that has just been finished.
        blocks: Finished blocks, those of earlier runs included.
        of: All blocks.
        episodes: Episodes played in this run.
    """

    layout: str
    blocks: int
    of: int
    episodes: int


def score(
    agent: Reference,
    protocol: str | Path | Protocol = NEWEST,
    pool: str | Path | None = None,
    layouts: Sequence[str] | None = None,
    output: str | Path | None = None,
    workers: int = 1,
    engine: str = "local",
    seed: int = 0,
    salt: str | None = None,
    act_timeout: float = ACT_TIMEOUT,
    on_progress: Callable[[Progress], None] = lambda _: None,
) -> Scored:
    """Scores an agent and writes score.json, episodes.sqlite, curve.png and report.html.

    The same folder again goes on where it was stopped; score.json is the same, apart from `run`, for any number of
    workers and any engine, and after any interruption.

    Args:
        agent: What `find` takes: a name, the path of a submission or of a policy, or a behaviour mapping.
        protocol: A shipped name, a file, or a Protocol.
        pool: Name or folder of another pool than the protocol's.
        layouts: Some of the protocol's layouts; all by default.
        output: The folder; `scores/<agent>-<protocol>` by default.
        workers: Processes.
        engine: "local", "dask" or "ray".
        seed: Other start states and random streams; scores that are to be compared use 0.
        salt: Replaces the protocol's public salt in every start state, random stream and order of rows; "fresh" draws
            one, or goes on with the one that was drawn for the folder. Official runs use a fresh one, so that a
            submission cannot compute who its partners are.
        act_timeout: Seconds that one call of a submission's `act` may take, for a whole batch of episodes; a slower one
            is a fault of the agent. Engine "local" only.
        on_progress: Called after each block.

    Raises:
        ScoringFault: The agent broke the contract while playing.
        AgentError: The agent cannot be loaded.
        PoolError: The pool is missing or damaged.
        ProtocolError: The protocol cannot be read, or does not fit the pool or the layouts.
        StoreError: The folder holds another score, or what it holds was changed: stored episodes are replayed.
        EngineError: The engine cannot be used.
    """
    started, clock = datetime.now(UTC), time.monotonic()
    rules = protocol if isinstance(protocol, Protocol) else load_protocol(protocol)
    entrant = find(agent, mode=rules.play.mode)
    source = pool or rules.play.pool
    if source is None:
        raise ProtocolError(f"protocol {rules.name!r} names no pool; name one with --pool")
    partners = Pool.load(source)
    chosen, skipped = _choose(rules, layouts, entrant)
    check_pool(partners, rules, chosen)
    for layout in chosen:
        if rules.play.start == "standard" and not Layout.load(layout).start_cells:
            raise ProtocolError(
                f"protocol {rules.name!r} plays start 'standard', but {layout} names no start cells; mark two with the "
                "digits 1 and 2, or write start: random"
            )
    folder = Path(output) if output else default_output(entrant.name, rules)
    used = _salt(salt, rules, folder)
    facts = {
        "protocol": rules.sha256,
        "agent": entrant.sha256,
        "pool": partners.hash,
        "seed": str(seed),
        "salt": used,
    }
    notes = {"settings": msgspec.json.encode(rules).decode(), "agent_name": entrant.name}
    home = str(partners.folder.absolute())
    with Store(folder / EPISODES_FILE, facts, notes) as store:
        blocks = [
            Block(
                agent=entrant.reference,
                agent_sha256=entrant.sha256,
                protocol=rules,
                pool=home,
                pool_sha256=partners.hash,
                salt=used,
                seed=seed,
                layout=layout,
                training_seed=run,
                episode=episode,
            )
            for episode in range(rules.play.episodes)
            for run in range(entrant.training_seeds)
            for layout in chosen
        ]
        with open_engine(engine, workers, apart=entrant.kind in RUNS_CODE) as opened:
            unknown = _play_all(store, blocks, opened, act_timeout, on_progress)
        attempted = [layout for layout in chosen if layout not in unknown]
        scored, overall = compute_layouts(store, rules, attempted, entrant.training_seeds, entrant.sha256)
    scores = Scores(
        schema=SCHEMA,
        protocol=Source(rules.name, rules.sha256),
        settings=rules,
        agent=Source(entrant.name, entrant.sha256),
        pool=Source(partners.name, partners.hash),
        seed=seed,
        salt=used,
        training_seeds=entrant.training_seeds,
        interval=describe_interval(entrant.training_seeds, rules.play.episodes),
        overall=overall,
        layouts=scored,
        not_attempted=tuple(layout for layout in (*chosen, *skipped) if layout not in attempted),
        run=_run_facts(started, time.monotonic() - clock, workers, engine),
    )
    draw_curve(scores, folder / CURVE_FILE)
    return _write(Scored(scores, folder))


def with_scenarios(scored: Scored, scenarios: ScenarioScore) -> Scored:
    """Adds how the agent did in the cooperation scenarios to a score and its files."""
    return _write(Scored(msgspec.structs.replace(scored.scores, scenarios=scenarios), scored.folder))


def _write(scored: Scored) -> Scored:
    write_report(scored.scores, scored.folder / REPORT_FILE)
    scored.scores.write(scored.folder / SCORES_FILE)
    return scored


def default_output(agent: str, protocol: Protocol) -> Path:
    """Gives the folder that a score is written to where none is named."""
    return Path("scores") / f"{agent}-{protocol.name}"


def _salt(salt: str | None, rules: Protocol, folder: Path) -> str:
    """Returns the run's salt: the public one unless another is given; "fresh" goes on with that of the folder."""
    public = rules.play.salt
    if salt is None:
        return public
    if not is_text(salt):
        raise ProtocolError(f"salt is {salt!r}; give a text, or {FRESH!r} for a salt that nobody knows")
    if salt != FRESH:
        return salt
    there = None
    if (folder / EPISODES_FILE).is_file():
        with Store(folder / EPISODES_FILE) as store:
            there = store.facts.get("salt") if store.blocks() else None
    return there if there not in (None, public) else draw_salt()


def _choose(rules: Protocol, layouts: Sequence[str] | None, entrant: Entrant) -> tuple[list[str], list[str]]:
    """Gives the layouts to play and those that the agent is known not to play."""
    strange = sorted(set(layouts or ()) - set(rules.play.layouts))
    if strange:
        raise ProtocolError(
            f"protocol {rules.name!r} does not play {', '.join(strange)}; choose among {', '.join(rules.play.layouts)}"
        )
    wanted = [layout for layout in rules.play.layouts if layouts is None or layout in layouts]
    if entrant.layout is None:
        return wanted, []
    known = [layout for layout in wanted if layout == entrant.layout]
    if not known:
        raise ProtocolError(f"{entrant.name} plays {entrant.layout} alone, which is not among {', '.join(wanted)}")
    return known, [layout for layout in wanted if layout != entrant.layout]


def _play_all(
    store: Store, blocks: Sequence[Block], engine: Engine, act_timeout: float, on_progress: Callable[[Progress], None]
) -> set[str]:
    """Plays the blocks that the store lacks; gives the layouts that the agent does not know."""
    finished = store.blocks()
    if finished:
        check_returns(store, blocks[0].protocol.play.cooking, blocks[0].protocol.play.horizon)
    to_play = [block for block in blocks if block.key not in finished]
    done, episodes = len(blocks) - len(to_play), 0
    unknown: dict[str, str] = {}
    faults: list[str] = []
    unstopped = takewhile(lambda _: not faults, to_play)  # after a fault, what is being played is still stored
    for outcome in engine.map(play_block, unstopped, _lost, act_timeout):
        layout = outcome.key[0]
        if outcome.fault is not None:
            faults.append(outcome.fault)
            continue
        if outcome.unknown is not None:
            unknown[layout] = outcome.unknown
        else:
            store.add_block(outcome.key, outcome.episodes, outcome.adapted)
            episodes += len(outcome.episodes)
        done += 1
        on_progress(Progress(layout, done, len(blocks), episodes))
    if faults:
        raise ScoringFault(min(faults))
    for layout in sorted({block.layout for block in blocks if block.key in store.blocks()} & set(unknown)):
        raise ScoringFault(f"{layout}: the agent played some blocks and not others ({unknown[layout]})")
    return set(unknown)


def _lost(block: Block, why: str) -> Outcome:
    """Blames the agent for a block whose worker process died or was overdue."""
    where = f"{block.layout}, training seed {block.training_seed}, episode {block.episode}"
    return Outcome(block.key, fault=f"{where}: {why}")


def _run_facts(started: datetime, seconds: float, workers: int, engine: str) -> dict[str, Any]:
    versions = {}
    for package in _PACKAGES:
        try:
            versions[package] = version(package)
        except PackageNotFoundError:  # from a source tree
            versions[package] = "unknown"
    return {
        "started": started.isoformat(timespec="seconds"),
        "seconds": round(seconds, 1),
        "workers": workers,
        "engine": engine,
        "python": platform.python_version(),
        "machine": platform.machine(),
        "versions": versions,
    }
