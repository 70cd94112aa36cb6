"""What a pull request changes: one new folder of the results, of four files at most, or it is not reviewed."""

import re
from typing import Final, NamedTuple

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.scores import EPISODES_FILE, SCORES_FILE
from overcooked_bench.files import NAME, shown
from overcooked_bench.leaderboard.submission.archive import SUFFIX
from overcooked_bench.leaderboard.submission.manifest import MANIFEST

RESULTS: Final = "results"
"""The folder of the repository that has a folder for each entry."""
_ADDED: Final = ("A", "added")
_NEEDED: Final = (SCORES_FILE, EPISODES_FILE, MANIFEST)
_WANTED: Final = (
    f"a pull request adds one new folder {RESULTS}/NAME-PROTOCOL with {', '.join(_NEEDED)} and, to be ranked, "
    f"NAME{SUFFIX}, and changes nothing else"
)


class ReviewError(WrongUse):
    """A pull request cannot be reviewed; the message says what to change."""


class Added(NamedTuple):
    """The entry that a pull request adds.

    Attributes:
        name: Of its folder.
        packed: Name of the packed submission in it; None if there is none.
    """

    name: str
    packed: str | None

    @property
    def files(self) -> tuple[str, ...]:
        """The names of its files."""
        return (*_NEEDED, self.packed) if self.packed else _NEEDED


def entry_of(changes: str) -> Added:
    """Returns the entry that is added.

    Args:
        changes: A line for each changed file: what became of it (`A` as git writes it, or `added`), a tab, its path.

    Raises:
        ReviewError: Anything else is changed than is wanted.
    """
    lines = [line for line in changes.splitlines() if line.strip()]
    if not lines:
        raise ReviewError(f"nothing is changed; {_WANTED}")
    found: dict[str, list[str]] = {}
    for line in lines:
        status, _, path = line.partition("\t")
        parts = re.fullmatch(rf"{RESULTS}/({NAME})/({NAME})", path)
        if status not in _ADDED or parts is None or not _belongs(*parts.groups()):
            raise ReviewError(f"{shown(line)!r}: not part of a new entry; {_WANTED}")
        found.setdefault(parts[1], []).append(parts[2])
    if len(found) > 1:
        raise ReviewError(f"{len(found)} entries, {shown(', '.join(sorted(found)))}; {_WANTED}")
    ((name, files),) = found.items()
    if missing := [file for file in _NEEDED if file not in files]:
        raise ReviewError(f"{RESULTS}/{name}: without {', '.join(missing)}; {_WANTED}")
    packed = [file for file in files if file not in _NEEDED]
    if len(packed) > 1:
        raise ReviewError(f"{RESULTS}/{name}: {len(packed)} packed submissions; {_WANTED}")
    return Added(name, packed[0] if packed else None)


def _belongs(entry: str, file: str) -> bool:
    """Returns whether a file can be one of an entry."""
    return file in _NEEDED or (file.endswith(SUFFIX) and entry.startswith(f"{file.removesuffix(SUFFIX)}-"))
