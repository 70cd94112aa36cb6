"""Reviews a new entry: its files, its submission and its result, without believing anything of it."""

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Final

import msgspec

from overcooked_bench.agents.isolation.settings import IsolationError
from overcooked_bench.errors import OvercookedBenchError
from overcooked_bench.estimate import Estimate
from overcooked_bench.evaluation.scores import Source, read_scores
from overcooked_bench.files import read_regular, shown
from overcooked_bench.leaderboard.audit.audit import audit
from overcooked_bench.leaderboard.audit.records import Check, Flag, Status, Table
from overcooked_bench.leaderboard.review.changes import RESULTS, Added, ReviewError, entry_of
from overcooked_bench.leaderboard.submission.archive import SUFFIX, unpack
from overcooked_bench.leaderboard.submission.check import check_submission
from overcooked_bench.leaderboard.submission.manifest import MANIFEST, load_manifest

if TYPE_CHECKING:
    from overcooked_bench.agents.isolation.settings import How

SCHEMA: Final = 1
_MOST_BYTES: Final = 300_000_000
"""Of a file; an archive has 256 MiB at most."""
_MOST: Final = 40
"""Problems that a review keeps."""


class Review(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What came of a review.

    Attributes:
        schema: Version of this form.
        name: Of the entry.
        problems: What has to be changed before anything else is looked at.
        protocol: What was played; null if the result cannot be read.
        overall: The first headline over all layouts; null if there is none.
        training_seeds: Of the agent.
        status: How far the result can be relied on.
        table: Where it would stand.
        checks: Of the audit.
        flags: Of the audit.
    """

    schema: int
    name: str
    problems: tuple[str, ...] = ()
    protocol: Source | None = None
    overall: Estimate | None = None
    training_seeds: int = 0
    status: Status = "reported"
    table: Table = "unranked"
    checks: tuple[Check, ...] = ()
    flags: tuple[Flag, ...] = ()

    @property
    def sound(self) -> bool:
        """Returns whether nothing is wrong."""
        return not self.problems and all(check.verdict != "failed" for check in self.checks)


def review(
    checkout: str | Path,
    changes: str,
    *,
    isolate: "How" = "strict",
    workers: int = 1,
) -> Review:
    """Reviews the entry that a pull request adds; its code runs in isolation only.

    Args:
        checkout: The repository with the pull request merged, of which only the entry's files are read.
        changes: As for `entry_of`.
        isolate: As for `audit`.
        workers: Number of processes.

    Raises:
        IsolationError: Its agent cannot be isolated as it should be.
    """
    try:
        added = entry_of(changes)
    except ReviewError as error:
        return Review(schema=SCHEMA, name="", problems=(str(error),))
    with tempfile.TemporaryDirectory(prefix="review-") as home:
        return _review(Path(checkout, RESULTS, added.name), added, Path(home, added.name), isolate, workers)


def _review(source: Path, added: Added, copy: Path, isolate: "How", workers: int) -> Review:
    name = added.name
    if problems := _copy(source, added, copy):
        return Review(schema=SCHEMA, name=name, problems=problems)
    try:
        manifest, scores, agent = load_manifest(copy / MANIFEST), read_scores(copy), None
        if name != (meant := f"{manifest.name}-{scores.protocol.name}"):
            problems = (f"the folder is {name!r}, and its name and protocol make {meant!r}",)
        elif added.packed and added.packed != (file := f"{manifest.name}{SUFFIX}"):
            problems = (f"the packed submission is {added.packed!r}, and its name makes {file!r}",)
        elif added.packed:
            problems = check_submission(copy / added.packed).problems
        if problems:
            return Review(schema=SCHEMA, name=name, problems=problems[:_MOST])
        if added.packed:
            agent = str(copy / "agent" / manifest.name)
            unpack(copy / added.packed, agent)
        found = audit(copy, agent, isolate=isolate, workers=workers)
    except IsolationError:
        raise
    except OvercookedBenchError as error:
        return Review(schema=SCHEMA, name=name, problems=tuple(_lines(error, copy)))
    return Review(
        schema=SCHEMA,
        name=name,
        protocol=found.protocol,
        overall=scores.overall,
        training_seeds=scores.training_seeds,
        status=found.status,
        table=found.table,
        checks=found.checks,
        flags=found.flags,
    )


def _copy(source: Path, added: Added, copy: Path) -> tuple[str, ...]:
    """Copies the files of an entry, regular ones only; returns what is wrong."""
    copy.mkdir()
    problems = []
    for file in added.files:
        try:
            (copy / file).write_bytes(read_regular(source / file, _MOST_BYTES, raises=ReviewError, follow_links=False))
        except ReviewError as error:
            problems += _lines(error, source)
    return tuple(problems)


def _lines(error: Exception, folder: Path) -> list[str]:
    """Returns the lines of a message, without the path of a folder."""
    return [shown(line.replace(f"{folder}/", ""), 400) for line in str(error).splitlines()[:_MOST]]
