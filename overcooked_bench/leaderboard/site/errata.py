"""Errata: what was found to be wrong after it was published, kept in `errata.yaml` of the results.

schema: 1
errata:
- date: 2026-12-01
about: v1
said: the floor on coordination_ring was measured with the wrong seat; scores of before are marked
"""

import re
from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.documents import LONGEST, parse_yaml
from overcooked_bench.files import read_text
from overcooked_bench.leaderboard.site.entries import EntryError

ERRATA_FILE: Final = "errata.yaml"
SCHEMA: Final = 1


class Erratum(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """One correction.

    Attributes:
        date: The day on which it was published, YYYY-MM-DD.
        about: The protocol, layout or entry, or what else was wrong.
        said: What was wrong, and what was done.
    """

    date: str
    about: str
    said: str

    def __post_init__(self) -> None:
        if not re.fullmatch(r"\d{4}-\d\d-\d\d", self.date):
            raise ValueError(f"date is {self.date!r}; write a day as 'YYYY-MM-DD', in quotes")
        for name, text in (("about", self.about), ("said", self.said)):
            if not (text.strip() and text.isprintable()):
                raise ValueError(f"{name} is {text!r}; write one line")


class _File(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    schema: int
    errata: tuple[Erratum, ...]


def read_errata(results: str | Path) -> tuple[Erratum, ...]:
    """Reads the errata of a folder of results, the latest first; none if there is no such file.

    Raises:
        EntryError: The file cannot be read; names the line.
    """
    file = Path(results) / ERRATA_FILE
    if not file.exists():
        return ()
    document = parse_yaml(read_text(file, LONGEST, raises=EntryError), str(file), EntryError)
    found = document.convert(_File)
    if found.schema != SCHEMA:
        raise document.error(("schema",), f"`schema` is {found.schema}; write `schema: {SCHEMA}`")
    return tuple(sorted(found.errata, key=lambda one: (one.date, one.about), reverse=True))
