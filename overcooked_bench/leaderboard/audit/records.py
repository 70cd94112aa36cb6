"""`Audit`: the record of an audit, `audit.json` beside the audited result, and what standing follows from it."""

import re
from datetime import date
from pathlib import Path
from typing import Any, Final, Literal

import msgspec

from overcooked_bench.documents import read_json
from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.scores import Source, in_folder
from overcooked_bench.files import write_whole

AUDIT_FILE: Final = "audit.json"
SCHEMA: Final = 1

Status = Literal["reproduced", "spot-checked", "reported", "withdrawn"]
"""All cells were played again; some of them; none, or something was wrong; taken back for a reason."""
Table = Literal["main", "open", "unranked"]
Verdict = Literal["passed", "failed", "not checked"]

_MOST_BYTES: Final = 16_000_000


class AuditError(WrongUse):
    """An audit cannot be done, or its record not be read; the message says what to do about it."""


class Check(msgspec.Struct, frozen=True):
    """One thing that an audit looks at.

    Attributes:
        name: What was looked at.
        verdict: What came of it.
        said: What was compared and how, or why it could not be; one line.
        problems: What is wrong, one line each; empty unless it failed.
    """

    name: str
    verdict: Verdict
    said: str
    problems: tuple[str, ...] = ()


class Flag(msgspec.Struct, frozen=True):
    """Something unusual that a person should look at; no verdict, it changes no standing.

    Attributes:
        kind: "similarity", "above the ceiling", "seat gap" or "identical runs".
        said: What was seen, one line.
        layout: Where; null for all layouts.
        value: The number that is unusual.
    """

    kind: str
    said: str
    layout: str | None
    value: float


class Withdrawal(msgspec.Struct, frozen=True):
    """Why and when a result was taken back; its record stays.

    Attributes:
        date: The day, YYYY-MM-DD.
        reason: One line.
    """

    date: str
    reason: str

    def __post_init__(self) -> None:
        try:
            right = re.fullmatch(r"\d{4}-\d\d-\d\d", self.date) is not None and bool(date.fromisoformat(self.date))
        except ValueError:
            right = False
        if not right:
            raise ValueError(f"date is {self.date!r}; write a day as YYYY-MM-DD")
        if not (self.reason.strip() and self.reason.isprintable()):
            raise ValueError("reason is empty or not one printable line; say in a line why the result is taken back")


class Audit(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The record of an audit.

    Attributes:
        schema: Version of this form.
        date: The day of the audit, UTC, YYYY-MM-DD.
        version: The version of overcooked-bench that audited.
        protocol: The protocol of the result.
        agent: Who was scored.
        pool: The partners.
        score_sha256: Hash of the bytes of score.json; a result that was changed since needs another audit.
        episodes_sha256: Hash of the bytes of episodes.sqlite.
        salt: The run's.
        official: Whether that salt is another than the protocol's public one.
        seed: What the cells to be played again were drawn with, drawn itself when the audit began.
        cells: How many cells the result has.
        played: How many of them were played again with the agent.
        used_pool: Whether the submission says that it trained or selected with the pool; null if nobody says.
        unranked: Why the score says it is not to be ranked; null if it is.
        checks: What was looked at.
        flags: What is unusual.
        withdrawn: Set once a result is taken back.
        manifest_sha256: Hash of the submission.yaml that it was compared with; null if there was none.
    """

    schema: int
    date: str
    version: str
    protocol: Source
    agent: Source
    pool: Source | None
    score_sha256: str
    episodes_sha256: str
    salt: str
    official: bool
    seed: int
    cells: int
    played: int
    used_pool: bool | None
    unranked: str | None
    checks: tuple[Check, ...]
    flags: tuple[Flag, ...] = ()
    withdrawn: Withdrawal | None = None
    manifest_sha256: str | None = None

    @property
    def sound(self) -> bool:
        """Returns whether nothing is wrong."""
        return all(check.verdict != "failed" for check in self.checks)

    @property
    def status(self) -> Status:
        """Returns how far the result can be relied on."""
        if self.withdrawn is not None:
            return "withdrawn"
        if not self.sound or not self.played:
            return "reported"
        return "reproduced" if self.played >= self.cells else "spot-checked"

    @property
    def table(self) -> Table:
        """Returns its table: only what was played again is ranked, apart if it used the pool."""
        if self.status in ("reported", "withdrawn") or self.unranked is not None:
            return "unranked"
        return "open" if self.used_pool else "main"

    def withdraw(self, reason: str, day: str) -> "Audit":
        """Returns the record of the same result, taken back.

        Raises:
            AuditError: The reason or the day cannot be written.
        """
        try:
            return msgspec.structs.replace(self, withdrawn=Withdrawal(day, reason))
        except ValueError as error:
            raise AuditError(str(error)) from error

    def write(self, file: str | Path) -> None:
        """Writes audit.json, all or nothing. Standing and table are written too, for readers of the file."""
        content = {**msgspec.to_builtins(self), "sound": self.sound, "status": self.status, "table": self.table}
        write_whole(file, msgspec.json.format(msgspec.json.encode(content), indent=2).decode() + "\n")


def read_audit(source: str | Path) -> Audit:
    """Reads an audit.json. What it says about its standing is computed from its checks, and compared.

    Args:
        source: The file, or the folder of a score.

    Raises:
        AuditError: It is missing or damaged, of another schema, or its standing does not follow from its checks.
    """
    path = in_folder(source, AUDIT_FILE)
    content: dict[str, Any] = read_json(path, _MOST_BYTES, dict, AuditError)
    if content.get("schema") != SCHEMA:
        raise AuditError(f"{path}: its schema is {content.get('schema')!r}; this version reads {SCHEMA}")
    derived = {name: content.pop(name, None) for name in ("sound", "status", "table")}
    try:
        audit = msgspec.convert(content, Audit)
    except (ValueError, TypeError) as error:
        raise AuditError(f"{path}: not an audit.json of schema {SCHEMA} ({error})") from error
    for name, said in derived.items():
        if said != getattr(audit, name):
            follows = getattr(audit, name)
            raise AuditError(f"{path}: `{name}` is {said!r}, but its checks give {follows!r}; audit the result again")
    return audit
