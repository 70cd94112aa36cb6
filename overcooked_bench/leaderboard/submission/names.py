"""Which file names a submission may have: those that every file system keeps as they are, inside their folder."""

import re
from collections.abc import Iterable
from typing import Final

from overcooked_bench.files import shown

LONGEST_PATH: Final = 200
"""Characters of a path within the submission."""

DEEPEST: Final = 6
"""Folders inside each other."""

_PART: Final = re.compile(r"[A-Za-z0-9_][A-Za-z0-9_.+=-]*")
_RESERVED: Final = frozenset(
    {"con", "prn", "aux", "nul", *(f"{port}{i}" for port in ("com", "lpt") for i in range(10))}
)


def path_problem(path: str) -> str:
    """Says what is wrong with the path of a file in a submission.

    Args:
        path: As an archive or a folder has it, with `/` between its parts.

    Returns:
        The fault and what to do; an empty text if there is none.
    """
    if len(path) > LONGEST_PATH:
        return f"a path of {len(path)} characters; at most {LONGEST_PATH} are allowed, so shorten it"
    parts = path.split("/")
    if len(parts) > DEEPEST:
        return f"{len(parts) - 1} folders inside each other; at most {DEEPEST - 1} are allowed, so move it up"
    if ".." in parts or path.startswith(("/", "\\")) or re.match("[A-Za-z]:", path):
        return "a path that leads out of the submission's folder; give one inside it"
    for part in parts:
        if not _PART.fullmatch(part) or part.endswith("."):
            return (
                f"the name {shown(part)!r} is not the same on every system; use letters, digits and _ . + = -, "
                "beginning with a letter, digit or _ and not ending with a dot"
            )
        if part.partition(".")[0].lower() in _RESERVED:
            return f"{part!r} is the name of a device on Windows; rename it"
    return ""


def collisions(paths: Iterable[str]) -> list[str]:
    """Lists names that are one and the same where upper and lower case are not distinguished.

    Args:
        paths: Paths of files, as in `path_problem`.

    Returns:
        One message for each pair.
    """
    seen: dict[str, tuple[str, bool]] = {}
    found = []
    for path in sorted(set(paths)):
        parts = path.split("/")
        for end in range(1, len(parts) + 1):
            name, is_file = "/".join(parts[:end]), end == len(parts)
            other, was_file = seen.setdefault(name.lower(), (name, is_file))
            if other != name or was_file != is_file:
                found.append(f"{shown(name)} and {shown(other)} are one name on some systems; rename one of them")
                break
    return found
