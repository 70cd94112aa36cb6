"""What a pull request changes: one new folder of the results, of four files at most, or it is not reviewed."""

import re
from typing import Final

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.scores import EPISODES_FILE, SCORES_FILE
from overcooked_bench.files import NAME, shown
from overcooked_bench.leaderboard.submission.archive import SUFFIX
from overcooked_bench.leaderboard.submission.manifest import MANIFEST

RESULTS: Final = "results"
"""The folder of the repository that has a folder for each entry."""
_ADDED: Final = ("A", "added")
_WANTED: Final = (
    f"a pull request adds one new folder {RESULTS}/NAME with {SCORES_FILE}, {EPISODES_FILE}, {MANIFEST} and, to be "
    f"ranked, NAME{SUFFIX}, and changes nothing else"
)


class ReviewError(WrongUse):
    """A pull request cannot be reviewed; the message says what to change."""


def entry_of(changes: str) -> str:
    """Returns the name of the entry that is added.

    Args:
        changes: A line for each changed file: what became of it (`A` as git writes it, or `added`), a tab, its path.

    Raises:
        ReviewError: Anything else is changed than is wanted.
    """
    lines = [line for line in changes.splitlines() if line.strip()]
    if not lines:
        raise ReviewError(f"nothing is changed; {_WANTED}")
    names: set[str] = set()
    for line in lines:
        status, _, path = line.partition("\t")
        found = re.fullmatch(rf"{RESULTS}/({NAME})/([^/]+)", path)
        if status not in _ADDED or found is None or found[2] not in files_of(found[1]):
            raise ReviewError(f"{shown(line)!r}: not part of a new entry; {_WANTED}")
        names.add(found[1])
    if len(names) > 1:
        raise ReviewError(f"{len(names)} entries, {shown(', '.join(sorted(names)))}; {_WANTED}")
    return names.pop()


def files_of(name: str) -> tuple[str, ...]:
    """Lists the files that an entry may have; all but the last one are needed."""
    return SCORES_FILE, EPISODES_FILE, MANIFEST, f"{name}{SUFFIX}"
