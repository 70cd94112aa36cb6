"""What the commands about games share: which layouts are meant, and how numbers of games are written."""

from collections.abc import Iterable
from pathlib import Path

from overcooked_bench.errors import WrongUse


def check_layouts(file: str | Path, wanted: Iterable[str] | None, played: Iterable[str]) -> None:
    """Makes sure that the layouts which a user names are played in a file.

    Raises:
        WrongUse: One is not; says which are.
    """
    there = list(dict.fromkeys(played))
    if strange := sorted(set(wanted or ()) - set(there)):
        raise WrongUse(f"{file}: nothing is played on {', '.join(strange)}; there are {', '.join(there) or 'no games'}")


def counted(number: int, what: str) -> str:
    """Writes "1 game" or "2 games"."""
    return f"{number:,} {what}{'s' * (number != 1)}"
