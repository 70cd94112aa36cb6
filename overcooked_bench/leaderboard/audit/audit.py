"""Audits a result: checks everything that can be checked with what is given, and says what could not be."""

import hashlib
import secrets
from collections.abc import Callable, Iterable
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import TYPE_CHECKING, Final

from overcooked_bench.agents.pools.pool import Pool
from overcooked_bench.documents import read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.games.facts import read_facts
from overcooked_bench.evaluation.games.replayed import check_returns, read_settings
from overcooked_bench.evaluation.games.store import Store
from overcooked_bench.evaluation.protocol import Protocol
from overcooked_bench.evaluation.scores import EPISODES_FILE, SCORES_FILE, Scores, ScoresError, read_scores
from overcooked_bench.evaluation.scores import SCHEMA as NEWEST_SCORES
from overcooked_bench.evaluation.summary import recompute
from overcooked_bench.files import shown
from overcooked_bench.leaderboard.audit import flags
from overcooked_bench.leaderboard.audit.claims import claims_of
from overcooked_bench.leaderboard.audit.numbers import differences
from overcooked_bench.leaderboard.audit.origins import (
    cell_problems,
    fault_problems,
    partner_problems,
    protocol_problems,
)
from overcooked_bench.leaderboard.audit.playing import AGAIN, Wanted, play_checks
from overcooked_bench.leaderboard.audit.records import (
    AUDIT_FILE,
    SCHEMA,
    Audit,
    AuditError,
    Check,
    Flag,
    Withdrawal,
    read_audit,
)
from overcooked_bench.leaderboard.hidden import hidden_pool

if TYPE_CHECKING:
    from overcooked_bench.agents.isolation.settings import How

_MOST_BYTES: Final = 64_000_000
_MOST_PROBLEMS: Final = 20
"""Problems of a check that a record keeps."""
_LONGEST: Final = 400  # characters of a problem


def audit(
    result: str | Path,
    agent: str | None = None,
    *,
    pool: str | Path | None = None,
    everything: bool = False,
    isolate: "How | None" = None,
    act_timeout: float = 60.0,
    workers: int = 1,
) -> Audit:
    """Audits a result and writes audit.json beside it; a withdrawal that stands there is kept.

    Args:
        result: The folder of a score.
        agent: The scored agent, as `score` takes it; without it the result stays unranked.
        pool: Name or folder of the pool that was played with; the protocol's by default.
        everything: Whether to play all cells again instead of 2 %, 20 at least.
        isolate: Plays a submission in processes of its own, as `score` does.
        act_timeout: Seconds that one call of a submission's `act` may take.
        workers: Number of processes.

    Returns:
        The record; `Audit.sound` says whether nothing is wrong.

    Raises:
        AuditError: There is no result to audit, its audit.json is damaged, or the pool that is named is.
        AgentError: The agent cannot be loaded.
        IsolationError: It cannot be isolated as it should be.
    """
    folder, seed = Path(result), secrets.randbits(32)
    kept = _withdrawal(folder)
    hashes = [_hash(folder / name) for name in (SCORES_FILE, EPISODES_FILE)]
    try:
        scores = read_scores(folder)
    except ScoresError as error:
        raise AuditError(f"{error}; there is nothing to audit") from error
    wanted = Wanted(agent, everything, isolate, act_timeout, workers, seed)
    claims = claims_of(folder, agent, scores)
    checks, flagged, cells, played = _checked(folder, scores, pool, wanted)
    found = Audit(
        schema=SCHEMA,
        date=datetime.now(UTC).date().isoformat(),
        version=version("overcooked-bench"),
        protocol=scores.protocol,
        agent=scores.agent,
        pool=scores.pool,
        score_sha256=hashes[0],
        episodes_sha256=hashes[1],
        salt=scores.salt,
        official=scores.salt != scores.settings.play.salt,
        seed=seed,
        cells=cells,
        played=played,
        used_pool=claims.used_pool,
        unranked=scores.unranked,
        checks=(*claims.checks, *checks),
        flags=tuple(flagged),
        withdrawn=kept,
        manifest_sha256=claims.sha256,
    )
    found.write(folder / AUDIT_FILE)
    return found


def withdraw(result: str | Path, reason: str, day: str | None = None) -> Audit:
    """Takes an audited result back: its files stay, its audit.json says when and why.

    Args:
        result: The folder of a score with an audit.json.
        reason: One line.
        day: YYYY-MM-DD; today by default.

    Raises:
        AuditError: There is no audit.json, or the reason or the day cannot be written.
    """
    taken = read_audit(result).withdraw(reason, day or datetime.now(UTC).date().isoformat())
    taken.write(Path(result) / AUDIT_FILE)
    return taken


def _checked(
    folder: Path, scores: Scores, instead: str | Path | None, wanted: Wanted
) -> tuple[list[Check], list[Flag], int, int]:
    """Returns the checks, the flags, the number of cells, and how many of them were played again."""
    checks = [_check("schema", "score.json is of the newest schema", lambda: _schema_problems(folder))]
    try:
        with Store(folder / EPISODES_FILE) as store:
            rules = read_settings(store)
            cells = sum(1 for _ in store.episodes())
            return _of_store(store, rules, scores, instead, wanted, checks, cells)
    except WrongUse as error:
        if not isinstance(error, AuditError):
            checks.append(Check("episodes", "failed", "checksums and form of the store", (_line(error),)))
            return checks, [], 0, 0
        raise


def _of_store(
    store: Store,
    rules: Protocol,
    scores: Scores,
    instead: str | Path | None,
    wanted: Wanted,
    checks: list[Check],
    cells: int,
) -> tuple[list[Check], list[Flag], int, int]:
    seeds = scores.training_seeds
    checks.append(Check("episodes", "passed", f"checksums and form of {cells:,} episodes"))
    checks.append(
        _check(
            "protocol",
            "its hash, the shipped one, what was declined",
            lambda: protocol_problems(store, scores, rules, instead is not None),
        )
    )
    checks.append(
        _check(
            "faults", "each layout is finished, declined or has a fault", lambda: fault_problems(store, scores, rules)
        )
    )
    replayed = "joint actions of all cells bring the recorded points and soups"
    checks.append(_check("replay", replayed, lambda: _replay_problems(store, rules)))
    numbers = "every number of score.json, computed from the episodes"
    checks.append(
        _check("numbers", numbers, lambda: differences(scores, recompute(store.file, declined=scores.declined)))
    )
    try:
        pool = _load_pool(store, rules, instead)
    except WrongUse as error:
        if instead is not None:
            raise AuditError(f"{error}; name the pool that was played with") from error
        checks += [Check(name, "not checked", f"no pool: {_line(error)}") for name in ("pool", "cells", AGAIN)]
        return checks, [], cells, 0
    checks.append(
        _check(
            "pool",
            f"its hash, and all that is said of its partners ({pool.name}{_secret(pool)})",
            lambda: partner_problems(store, pool, rules),
        )
    )
    checks.append(
        _check(
            "cells",
            "each cell once; start states and sides from the salt and the seed",
            lambda: cell_problems(store, pool, rules, seeds),
        )
    )
    if any(check.verdict == "failed" for check in checks):
        checks.append(Check(AGAIN, "not checked", "something is wrong already"))
        return checks, [], cells, 0
    played = play_checks(store, scores, rules, pool, wanted)
    flagged = [
        *flags.same_as_partner(scores),
        *played.flags,
        *flags.uneven_seats(scores),
        *flags.of_episodes(store, scores),
    ]
    return [*checks, *played.checks], flagged, cells, played.played


def _check(name: str, said: str, look: Callable[[], Iterable[str]]) -> Check:
    """Looks, and lists what is wrong; what cannot be read is wrong."""
    problems: list[str] = []
    try:
        for problem in look():
            problems.append(_line(problem))
            if len(problems) == _MOST_PROBLEMS:
                problems.append("and perhaps more")
                break
    except (WrongUse, ValueError, LookupError) as error:
        problems.append(_line(error))
    return Check(name, "failed" if problems else "passed", said, tuple(problems))


def _schema_problems(folder: Path) -> list[str]:
    schema = read_json(folder / SCORES_FILE, _MOST_BYTES, dict).get("schema")
    newest = f"its schema is {schema!r}, not {NEWEST_SCORES}; run the same score command again, which writes it"
    return [] if schema == NEWEST_SCORES else [newest]


def _load_pool(store: Store, rules: Protocol, instead: str | Path | None) -> Pool:
    source = instead or read_facts(store).pool_given or rules.play.pool
    if source is None:
        raise AuditError("the protocol names no pool; name the one that was played with, with --pool")
    return Pool.load(source)


def _secret(pool: Pool) -> str:
    hidden = hidden_pool(pool.hash)
    return (
        "" if hidden is None else f", the hidden twin of {hidden.twin_of} whose hash was published {hidden.published}"
    )


def _withdrawal(folder: Path) -> Withdrawal | None:
    return read_audit(folder).withdrawn if (folder / AUDIT_FILE).exists() else None


def _hash(file: Path) -> str:
    try:
        with file.open("rb") as opened:
            return hashlib.file_digest(opened, "sha256").hexdigest()
    except OSError as error:
        raise AuditError(f"{file}: cannot be read ({error}); give the folder of a score") from error


def _line(problem: object) -> str:
    return " ".join(shown(str(problem), _LONGEST).split())


def _replay_problems(store: Store, rules: Protocol) -> list[str]:
    check_returns(store, rules.play.cooking, rules.play.horizon)
    return []
