"""`Entry`: what a folder of the results holds; nothing in it is trusted, and a bad one costs no other its row."""

import hashlib
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any, Final, NamedTuple

import msgspec

from overcooked_bench.documents import LONGEST, read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.beside import REFERENCES
from overcooked_bench.evaluation.protocol import Protocol, load_protocol, protocol_names
from overcooked_bench.evaluation.scores import SCORES_FILE, Scores, read_scores
from overcooked_bench.files import check_name, read_regular, shown
from overcooked_bench.leaderboard.audit.records import AUDIT_FILE, Audit, read_audit
from overcooked_bench.leaderboard.submission.manifest import MANIFEST, Manifest, load_manifest
from overcooked_bench.shelf import Shelf

FACTS_FILE: Final = "facts.json"
"""In the folder of a shipped row: what a submission.yaml would say."""

_MOST_BYTES: Final = 64_000_000


class EntryError(WrongUse):
    """An entry, or the folder of the results, cannot be shown; the message says why."""


_SHELF: Final = Shelf(
    "row", "overcooked_bench.baselines", f"/{SCORES_FILE}", EntryError, f"a folder with a {SCORES_FILE}", "board"
)


@dataclass(frozen=True)
class Entry:
    """A row of the leaderboard.

    Attributes:
        key: Name of its folder and of its page; that of a shipped one begins with `_`, which no folder does.
        scores: Its score.
        manifest: What it says of itself; None for a shipped one that says nothing.
        audit: What was looked at; None if nobody has.
        folder: Where it is; None for the bare score of a reference agent.
        shipped: Whether it ships with the package.
        parts: What each partner adds to the score of a single agent; empty for others.
    """

    key: str
    scores: Scores
    manifest: Manifest | None = None
    audit: Audit | None = None
    folder: Path | None = None
    shipped: bool = False
    parts: Mapping[tuple[str, str], float] = field(default_factory=dict)

    @property
    def name(self) -> str:
        """What it is called."""
        return self.scores.agent.name if self.manifest is None else self.manifest.name

    @property
    def status(self) -> str:
        """How far the result can be relied on; "reference" ships with the package."""
        if self.shipped:
            return "reference"
        return "reported" if self.audit is None else self.audit.status

    @property
    def table(self) -> str:
        """Where it stands.

        "unranked" unless somebody else played it again under a protocol that ranks; "open" if it trained or selected
        with the pool that scores it; else "main" for methods and "agents" for single agents.
        """
        scores = self.scores
        if scores.overall is None or not scores.settings.report.ranked or self.status in ("reported", "withdrawn"):
            return "unranked"
        pool = scores.pool
        says = self.manifest is not None and pool is not None and self.manifest.used(pool.name)
        if says or (self.audit is not None and self.audit.used_pool):
            return "open"
        if scores.unranked is not None or (self.audit is not None and self.audit.unranked is not None):
            return "unranked"
        return "main" if scores.kind == "method" else "agents"

    @property
    def remark(self) -> str:
        """Why it is where it stands, if that has to be said."""
        if self.audit is not None and self.audit.withdrawn is not None:
            return f"withdrawn on {self.audit.withdrawn.date}: {self.audit.withdrawn.reason}"
        if not self.shipped and self.audit is None:
            return "nobody has audited it"
        if self.audit is not None and not self.audit.sound:
            return "its audit failed"
        return shown(self.scores.unranked or "", 300)


class Refused(NamedTuple):
    """A folder that is not shown as an entry.

    Attributes:
        name: Its name, printable.
        reason: Why.
    """

    name: str
    reason: str


def entry_folders(results: str | Path) -> list[Path]:
    """Lists the folders of the results, each of which should be an entry.

    Args:
        results: A folder with one folder for each entry: score.json, submission.yaml, and audit.json once audited.

    Raises:
        EntryError: There is no such folder.
    """
    home = Path(results)
    if not home.is_dir():
        raise EntryError(f"{shown(home)}: no such folder; give the folder that holds one folder for each entry")
    return sorted(path for path in home.iterdir() if path.is_dir() and not path.name.startswith("."))


def shipped_rows() -> list[Entry]:
    """Reads the rows that ship with the package: reference agents and trained entries."""
    rows = []
    for name in _SHELF.names():
        folder = _SHELF.home / name
        facts: dict[str, Any] = read_json(folder / FACTS_FILE, LONGEST, dict, EntryError)
        scores = read_scores(folder)
        key = f"_{name}-{scores.protocol.name}"
        rows.append(Entry(key, scores, msgspec.convert(facts, Manifest), None, folder, shipped=True))
    known = {(one.scores.agent.name, one.scores.protocol.sha256) for one in rows}
    for file in sorted(REFERENCES.glob("*.json")):
        scores = read_scores(file)
        if (scores.agent.name, scores.protocol.sha256) not in known:
            rows.append(Entry(f"_{scores.agent.name}-{file.stem}", scores, shipped=True))
    return rows


def read_entry(folder: Path) -> Entry:
    """Reads an entry.

    Raises:
        WrongUse: Something in it cannot be read, or does not fit the rest.
    """
    check_name(folder.name, "the folder's name", EntryError)
    if folder.is_symlink():
        raise EntryError("a link; put the folder itself there")
    manifest, scores = load_manifest(folder / MANIFEST), read_scores(folder)
    if folder.name not in (manifest.name, f"{manifest.name}-{scores.protocol.name}"):
        raise EntryError(f"{MANIFEST} is of {manifest.name}; name the folder {manifest.name}, so that no two have it")
    if manifest.training_seeds != scores.training_seeds:
        raise EntryError(
            f"{MANIFEST} says {manifest.training_seeds} training seeds, {SCORES_FILE} {scores.training_seeds}"
        )
    _check_games(scores)
    audit = read_audit(folder) if (folder / AUDIT_FILE).exists() else None
    content = read_regular(folder / SCORES_FILE, _MOST_BYTES, raises=EntryError)
    if audit is not None and audit.score_sha256 != hashlib.sha256(content).hexdigest():
        raise EntryError(f"{AUDIT_FILE} is of another {SCORES_FILE}; audit it again")
    said = read_regular(folder / MANIFEST, _MOST_BYTES, raises=EntryError)
    if audit is not None and audit.manifest_sha256 not in (None, hashlib.sha256(said).hexdigest()):
        raise EntryError(f"{AUDIT_FILE} is of another {MANIFEST}; audit it again")
    return Entry(folder.name, scores, manifest, audit, folder)


@cache
def _shipped_protocols() -> dict[str, Protocol]:
    return {protocol.sha256: protocol for protocol in map(load_protocol, protocol_names())}


def _check_games(scores: Scores) -> None:
    """Checks that a score says which games it is of, and ranks by what these rank by: pages are named after hashes.

    Raises:
        EntryError: It does not.
    """
    sources = [scores.protocol, scores.agent, *([scores.pool] if scores.pool else [])]
    for source in sources:
        if not re.fullmatch("[0-9a-f]{64}", source.sha256):
            raise EntryError(f"{SCORES_FILE}: {shown(source.sha256)!r} is no SHA-256")
    if scores.settings.sha256 != scores.protocol.sha256:
        raise EntryError(f"{SCORES_FILE}: its protocol is not the one whose hash it says")
    report = scores.settings.report
    if not report.headlines:
        raise EntryError(f"{SCORES_FILE}: its protocol has no headlines, so nothing is ranked by it")
    known = _shipped_protocols().get(scores.protocol.sha256)
    if known is not None:
        said = scores.protocol.name, report.headlines, report.ranked
        if said != (known.name, known.report.headlines, known.report.ranked):
            raise EntryError(f"{SCORES_FILE}: the games of {known.name}, but another name or other headlines")
    elif scores.protocol.name in protocol_names():
        raise EntryError(f"{SCORES_FILE}: says {scores.protocol.name}, but of other games; rename the protocol")
    row = scores.find(report.headline)
    if scores.overall is not None and (row is None or row.estimate != scores.overall):
        raise EntryError(f"{SCORES_FILE}: `overall` is not its own {report.headline}")
