"""Scores an agent: plays it with every partner of a protocol and writes the results."""

import platform
import time
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from datetime import UTC, datetime
from importlib.metadata import PackageNotFoundError, version
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, Final, NamedTuple

import msgspec

from overcooked_bench.agents.agent import Reference
from overcooked_bench.agents.catalogue import find, runs_code
from overcooked_bench.agents.isolation.settings import Isolation
from overcooked_bench.agents.isolation.settings import isolate as isolated
from overcooked_bench.agents.kinds import Entrant
from overcooked_bench.agents.pools.lineage import at_home
from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.evaluation.beside import beside
from overcooked_bench.evaluation.cells import PartnerLabel, SideBound, pack_labels
from overcooked_bench.evaluation.games.asking import identify
from overcooked_bench.evaluation.games.block import Block
from overcooked_bench.evaluation.games.cutting import cut
from overcooked_bench.evaluation.games.engines import Engine, open_engine
from overcooked_bench.evaluation.games.replayed import check_returns
from overcooked_bench.evaluation.games.roster import check_pool, roster
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.games.streams import FRESH, draw_salt
from overcooked_bench.evaluation.isolating import NOTE, note_isolation
from overcooked_bench.evaluation.playing import Progress, play_blocks
from overcooked_bench.evaluation.protocol import NEWEST, Play, Protocol, ProtocolError, is_text, load_protocol
from overcooked_bench.evaluation.scenario_scores import ScenariosPlayed, play_scenarios, write_scenarios
from overcooked_bench.evaluation.scores import (
    CURVE_FILE,
    EPISODES_FILE,
    SCORES_FILE,
    Declined,
    Scores,
)
from overcooked_bench.evaluation.shown.report import write_report
from overcooked_bench.evaluation.shown.terminal import WIDTH, score_tables
from overcooked_bench.evaluation.summary import summarise
from overcooked_bench.kitchen.layout import Layout

if TYPE_CHECKING:
    from overcooked_bench.agents.isolation.settings import How
    from overcooked_bench.agents.policies.neural import Mode

ACT_TIMEOUT: Final = 60.0

_PACKAGES: Final = ("overcooked-bench", "numpy", "numba", "torch")


class Scored(NamedTuple):
    """The result of `score`.

    Attributes:
        scores: The content of score.json; `scores.faults` says what the agent did wrong.
        folder: Where the files are.
        episodes: How many were played in this run; 0 if all were there already.
        unwritten: Why the files could not be written, None if they were: a finished score on a read-only disk.
    """

    scores: Scores
    folder: Path
    episodes: int
    unwritten: str | None = None

    def table(self, explain: bool = False) -> str:
        """Returns the table that `overcooked-bench score` prints, as plain text.

        Args:
            explain: Whether thresholds, partners, cooperation and scenarios are shown too, and what the numbers mean.
        """
        from rich.console import Console

        console = Console(width=WIDTH, color_system=None, file=StringIO())
        with console.capture() as shown:
            console.print(score_tables(self.scores, beside(self.scores, self.folder), explain))
        return "\n".join(line.rstrip() for line in shown.get().rstrip().splitlines())


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
    isolate: "How | None" = None,
    scenarios: bool = True,
    on_progress: Callable[[Progress], object] = lambda _: None,
) -> Scored:
    """Scores an agent and writes score.json, episodes.sqlite, curve.png, report.html and scenarios.json.

    A call with the same folder continues an interrupted run; score.json is the same, apart from `run`, for any number
    of workers and any engine, and after any interruption. A fault of the agent ends only the block that it is in: it is
    listed in `Scores.faults`, finished blocks are kept, and the same call plays what is missing.

    Args:
        agent: What `find` takes: a name, the path of a submission or of a policy, or a behaviour mapping.
        protocol: A shipped name, a file, or a Protocol.
        pool: Name or folder of a pool to play with instead of the protocol's.
        layouts: A subset of the protocol's layouts; all by default. Only a score on all of them has an overall value.
        output: The folder; `scores/<agent>-<protocol>` by default.
        workers: Number of processes.
        engine: "local", "dask" or "ray".
        seed: Other start states and random streams; scores that are to be compared use 0, and no other one ranks.
        salt: Replaces the protocol's public salt in every start state, random stream and order of rows; "fresh" draws
            one, or continues with the one that was drawn for the folder. Official runs use a fresh one, so that a
            submission cannot compute who its partners are; with another one a score is not ranked.
        act_timeout: Seconds that one call of a submission's `act` may take, for a whole batch of episodes; a slower one
            is a fault of the agent.
        isolate: "best" plays a submission in processes of its own that see observations and return actions, in a
            sandbox of bubblewrap where there is one; "strict" insists on that. `Scores.run` says how good it was.
        scenarios: Whether to play the cooperation scenarios as well, which takes seconds.
        on_progress: Called after each block, and after each kitchen of scenarios.

    Raises:
        AgentError: The agent cannot be loaded.
        PoolError: The pool is missing or damaged.
        ProtocolError: The protocol cannot be read, or does not fit the pool or the layouts.
        StoreError: The folder holds another score, or what it holds was changed: stored episodes are replayed.
        EngineError: The engine cannot be used.
        IsolationError: The submission cannot be isolated as it should be.

    Example:
        ```python
        from overcooked_bench import score

        scored = score("my_agent.py", layouts=["cramped_room"], workers=2)
        print(scored.scores.overall, scored.scores.faults)
        for layout in scored.scores.layouts:
            print(layout.layout, scored.scores.find("n", layout=layout.layout).estimate)
        ```
    """
    started, clock = datetime.now(UTC), time.monotonic()
    rules = protocol if isinstance(protocol, Protocol) else load_protocol(protocol)
    play = rules.play
    untrusted = runs_code(agent)
    isolation = isolated(isolate, act_timeout) if isolate and untrusted else None
    patience = act_timeout if isolation is None else None
    with open_engine(engine, workers, apart=untrusted) as opened:
        entrant = _identify(agent, play.mode, opened, patience, isolation) if untrusted else find(agent, mode=play.mode)
        partners = _load_pool(rules, pool)
        chosen, skipped = _choose(rules, layouts, entrant)
        check_pool(partners, rules, chosen)
        folder = Path(output) if output else default_output(entrant.name, rules)
        used = _salt(salt, rules, folder)
        facts = {
            "protocol": rules.sha256,
            "agent": entrant.sha256,
            "pool": partners.hash,
            "seed": str(seed),
            "salt": used,
        }
        notes = {
            "settings": msgspec.json.encode(rules).decode(),
            "agent_name": entrant.name,
            **_as_given("agent", entrant.reference if isinstance(agent, Mapping) else agent),
            **_as_given("pool", pool),
            "pool_name": partners.name,
            "training_seeds": str(entrant.training_seeds),
            "partners": pack_labels({layout: _labels(partners, layout, entrant, play) for layout in chosen}),
        }
        home = str(partners.folder.absolute())
        with Store(folder / EPISODES_FILE, facts, notes) as store:
            check_returns(store, play.cooking, play.horizon)
            first = Block(
                agent=entrant.reference,
                agent_sha256=entrant.sha256,
                protocol=rules,
                pool=home,
                pool_sha256=partners.hash,
                salt=used,
                seed=seed,
                layout=chosen[0],
                training_seed=0,
                episodes=(0,),
                isolation=isolation,
            )
            blocks = cut(first, chosen, entrant.training_seeds)
            apart = note_isolation(
                store, isolation, store.blocks().issuperset(key for one in blocks for key in one.keys)
            )
            items = None
            played = play_blocks(store, blocks, opened, patience, on_progress, again=untrusted)
            if scenarios:
                items = play_scenarios(
                    *(entrant, play.mode, layouts, opened, patience),
                    lambda what, done, of: on_progress(Progress(what, done, of, played.episodes)),
                    isolation,
                )
            notes_on_run: dict[str, Any] = {NOTE: apart} if apart else {}
            if played.differs:
                notes_on_run["warnings"] = [f"{entrant.name} {played.differs}"]
            scores = summarise(
                store,
                rules,
                training_seeds=entrant.training_seeds,
                finished=played.finished,
                declined=(*played.declined, *skipped),
                faults=(*played.faults, *(items.faults if items else ())),
                scenarios=items and items.score,
                run={**_run_facts(started, time.monotonic() - clock, workers, engine), **notes_on_run},
                conduct=True,
            )
        unwritten = None
        try:
            _write(scores, items, folder)
        except OSError as error:
            if played.episodes:
                raise
            unwritten = str(error)
        return Scored(scores, folder, played.episodes, unwritten)


def _identify(
    agent: Reference, mode: "Mode", engine: Engine, patience: float | None, isolation: Isolation | None
) -> Entrant:
    """Finds a submission without running its code in this process, which it could end."""

    def lost(_: object, why: str) -> Entrant:
        raise AgentError(f"{agent}: {why}")

    (entrant,) = engine.map(identify, [(agent, mode, isolation)], lost, patience)
    return entrant


def default_output(agent: str, protocol: Protocol) -> Path:
    """Returns the folder that a score is written to by default."""
    return Path("scores") / f"{agent}-{protocol.name}"


def _salt(salt: str | None, rules: Protocol, folder: Path) -> str:
    """Returns the run's salt: the public one unless another is given; "fresh" continues with that of the folder."""
    public = rules.play.salt
    if salt is None:
        return public
    if not is_text(salt):
        raise ProtocolError(f"salt is {salt!r}; give a text, or {FRESH!r} for a new secret salt")
    if salt != FRESH:
        return salt
    there = None
    if (folder / EPISODES_FILE).is_file():
        with Store(folder / EPISODES_FILE) as store:
            there = store.facts.get("salt") if store.blocks() else None
    return there if there not in (None, public) else draw_salt()


def _load_pool(rules: Protocol, instead: str | Path | None) -> Pool:
    """Loads the pool that is played with, and makes sure that it is the one that the protocol means."""
    source = instead or rules.play.pool
    if source is None:
        raise ProtocolError(f"protocol {rules.name!r} names no pool; name one with --pool")
    pool, meant = Pool.load(source), rules.play.pool_sha256
    if instead is None and meant not in (None, pool.hash):
        raise ProtocolError(
            f"protocol {rules.name!r} means the pool {source!r} with the hash {meant}, but the one here has "
            f"{pool.hash}; take the release that the protocol comes with, or name a pool with --pool"
        )
    return pool


def _as_given(what: str, reference: str | Path | None) -> dict[str, str]:
    """Notes how an agent or a pool was named, unless by an absolute path, which says something about a machine."""
    return {} if reference is None or Path(reference).is_absolute() else {f"{what}_given": str(reference)}


def _labels(pool: Pool, layout: str, entrant: Entrant, play: Play) -> list[PartnerLabel]:
    return [
        PartnerLabel(
            *(one.name, one.kind, one.sha256, one.entry.stratum, one.entry.convention),
            weight=one.entry.weight,
            bounds=tuple(SideBound(b.side, b.floor, b.ceiling) for b in one.entry.bounds or ()) or None,
            home=entrant.origin and at_home(entrant.origin.codebase, entrant.origin.people, one.entry),
            is_ego=one.sha256 in (entrant.sha256, *entrant.policies.get(layout, ())),
        )
        for one in roster(pool, layout, play.per_stratum)
    ]


def _choose(rules: Protocol, layouts: Sequence[str] | None, entrant: Entrant) -> tuple[list[str], tuple[Declined, ...]]:
    """Returns the layouts to play, and those among them that the agent declines."""
    play = rules.play
    strange = sorted(set(layouts or ()) - set(play.layouts))
    if strange:
        raise ProtocolError(
            f"protocol {rules.name!r} does not play {', '.join(strange)}; choose among {', '.join(play.layouts)}"
        )
    wanted = [layout for layout in play.layouts if layouts is None or layout in layouts]
    known = [layout for layout in wanted if entrant.layout in (None, layout)]
    if not known:
        raise ProtocolError(f"{entrant.name} plays only {entrant.layout}, which is not among {', '.join(wanted)}")
    for layout in known:
        if play.start == "standard" and not Layout.load(layout).start_cells:
            raise ProtocolError(
                f"protocol {rules.name!r} plays start 'standard', but {layout} names no start cells; mark two with the "
                "digits 1 and 2, or write start: random"
            )
    return known, tuple(Declined(one, f"it plays only {entrant.layout}") for one in wanted if one not in known)


def _write(scores: Scores, items: ScenariosPlayed | None, folder: Path) -> None:
    """Writes the files, the numbers first: whatever the page shows besides may be damaged."""
    scores.write(folder / SCORES_FILE)
    for section in write_report(scores, folder):
        if "curves" in section.plots:
            section.plots["curves"].save(folder / CURVE_FILE)
    if items:
        write_scenarios(items, scores.agent.name, scores.settings.play.mode, folder)


def _run_facts(started: datetime, seconds: float, workers: int, engine: str) -> Mapping[str, Any]:
    versions = dict.fromkeys(_PACKAGES, "unknown")
    for package in _PACKAGES:
        with suppress(PackageNotFoundError):  # from a source tree
            versions[package] = version(package)
    return {
        "started": started.isoformat(timespec="seconds"),
        "seconds": round(seconds, 1),
        "workers": workers,
        "engine": engine,
        "python": platform.python_version(),
        "machine": platform.machine(),
        "versions": versions,
    }
