"""`Entry`: what a folder of the results holds; nothing in it is trusted, and a bad one costs no other its row."""

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import Final, NamedTuple

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.beside import REFERENCES
from overcooked_bench.evaluation.scores import SCORES_FILE, Scores, read_scores
from overcooked_bench.files import check_name, read_regular, shown
from overcooked_bench.leaderboard.audit.records import AUDIT_FILE, Audit, read_audit
from overcooked_bench.leaderboard.submission.manifest import MANIFEST, Manifest, load_manifest

_MOST_BYTES: Final = 64_000_000


class EntryError(WrongUse):
    """An entry, or the folder of the results, cannot be shown; the message says why."""


@dataclass(frozen=True)
class Entry:
    """A row of the leaderboard.

    Attributes:
        key: Name of its folder and of its page; that of a reference begins with `_`, which no folder does.
        scores: Its score.
        manifest: What it says of itself; None for a reference, which ships with the package.
        audit: What was looked at; None if nobody has.
    """

    key: str
    scores: Scores
    manifest: Manifest | None = None
    audit: Audit | None = None

    @property
    def name(self) -> str:
        """What it is called."""
        return self.scores.agent.name if self.manifest is None else self.manifest.name

    @property
    def status(self) -> str:
        """How far the result can be relied on; "reference" ships with the package."""
        if self.manifest is None:
            return "reference"
        return "reported" if self.audit is None else self.audit.status

    @property
    def table(self) -> str:
        """Where it stands: "main", "open" if it trained or selected with the pool that scores it, or "unranked"."""
        if self.scores.overall is None or self.scores.unranked is not None:
            return "unranked"
        if self.manifest is None:
            return "main"
        if self.audit is None:
            return "unranked"
        pool = self.scores.pool
        used = pool is not None and self.manifest.used(pool.name)
        return "open" if used and self.audit.table == "main" else self.audit.table

    @property
    def remark(self) -> str:
        """Why it is where it stands, if that has to be said."""
        if self.audit is not None and self.audit.withdrawn is not None:
            return f"withdrawn on {self.audit.withdrawn.date}: {self.audit.withdrawn.reason}"
        if self.manifest is not None and self.audit is None:
            return "nobody has audited it"
        if self.audit is not None and not self.audit.sound:
            return "its audit failed"
        return self.scores.unranked or ""


class Refused(NamedTuple):
    """A folder that is not shown as an entry.

    Attributes:
        name: Its name, printable.
        reason: Why.
    """

    name: str
    reason: str


def read_entries(results: str | Path) -> tuple[list[Entry], list[Refused]]:
    """Reads every folder of the results, and the references that ship with the package.

    Args:
        results: A folder with one folder for each entry: score.json, submission.yaml, and audit.json once audited.

    Returns:
        The entries, in the order of their keys, and what was refused.

    Raises:
        EntryError: There is no such folder.
    """
    home = Path(results)
    if not home.is_dir():
        raise EntryError(f"{shown(home)}: no such folder; give the folder that holds one folder for each entry")
    entries = [Entry(f"_{scores.agent.name}-{file.stem}", scores) for file, scores in _references()]
    refused = []
    for folder in sorted(path for path in home.iterdir() if path.is_dir() and not path.name.startswith(".")):
        try:
            entries.append(read_entry(folder))
        except (WrongUse, OSError) as error:
            reason = str(error).replace(str(folder), folder.name)
            refused.append(Refused(shown(folder.name, 100), shown(reason, 400)))
    return entries, refused


def read_entry(folder: Path) -> Entry:
    """Reads an entry.

    Raises:
        WrongUse: Something in it cannot be read, or does not fit the rest.
    """
    check_name(folder.name, "the folder's name", EntryError)
    if folder.is_symlink():
        raise EntryError("a link; put the folder itself there")
    manifest, scores = load_manifest(folder / MANIFEST), read_scores(folder)
    if scores.settings.sha256 != scores.protocol.sha256:
        raise EntryError(f"{SCORES_FILE}: its protocol is not the one whose hash it gives")
    if not scores.settings.report.headlines:
        raise EntryError(f"{SCORES_FILE}: its protocol has no headlines, so nothing is ranked by it")
    if manifest.training_seeds != scores.training_seeds:
        raise EntryError(
            f"{MANIFEST} says {manifest.training_seeds} training seeds, {SCORES_FILE} {scores.training_seeds}"
        )
    audit = read_audit(folder) if (folder / AUDIT_FILE).exists() else None
    content = read_regular(folder / SCORES_FILE, _MOST_BYTES, raises=EntryError)
    if audit is not None and audit.score_sha256 != hashlib.sha256(content).hexdigest():
        raise EntryError(f"{AUDIT_FILE} is of another {SCORES_FILE}; audit it again")
    return Entry(folder.name, scores, manifest, audit)


def _references() -> list[tuple[Path, Scores]]:
    return [(file, read_scores(file)) for file in sorted(REFERENCES.glob("*.json"))]
