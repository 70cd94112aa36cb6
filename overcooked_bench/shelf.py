"""Looks names up: files that ship under a name, paths instead of names, and a guess at what was meant."""

import difflib
from collections.abc import Iterable
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Final

from overcooked_bench.errors import WrongUse
from overcooked_bench.files import is_file, shown

_LONGEST: Final = 200  # characters of a name that is worth a guess; difflib takes seconds for very long ones


def guess(given: object, known: Iterable[str], most: int = 1, cutoff: float = 0.4) -> str:
    """Returns "did you mean 'greedy'? ", with a space at the end, for a message; an empty text if nothing is near.

    Args:
        given: What was written.
        known: The names that exist.
        most: Number of guesses at most.
        cutoff: Least similarity of a guess, from 0 to 1, as in `difflib.get_close_matches`.
    """
    near = difflib.get_close_matches(str(given)[:_LONGEST], list(known), n=most, cutoff=cutoff)
    return f"did you mean {' or '.join(map(repr, near))}? " if near else ""


@dataclass(frozen=True)
class Shelf:
    """A folder of the package whose files ship under names; a path can be given instead of a name.

    Attributes:
        what: The kind of its files, for messages: "protocol".
        package: The package that holds the folder.
        suffix: Suffix of the names: ".yaml", or "/manifest.json" if each name is a folder that contains that file.
        raises: The class of the error.
        path: The kind of file at a path, for messages: "a YAML file".
        folder: Folder within the package.
        first: Names that are listed first, in this order.
    """

    what: str
    package: str
    suffix: str
    raises: type[WrongUse]
    path: str
    folder: str = ""
    first: tuple[str, ...] = ()

    @property
    def home(self) -> Path:
        """The folder."""
        return Path(str(files(self.package)), self.folder)

    def names(self) -> tuple[str, ...]:
        """Lists the names that ship."""
        home = self.home
        found = {file.relative_to(home).as_posix().removesuffix(self.suffix) for file in home.glob(f"*{self.suffix}")}
        return *self.first, *sorted(found - set(self.first))

    def file(self, source: str | Path) -> Path | None:
        """Returns the file of a name of `names()` or of a path (of a folder if names are folders); else None."""
        if str(source) in self.names():
            return self.home / f"{source}{self.suffix}"
        given = Path(f"{source}{self.suffix}" if self.suffix.startswith("/") else source)
        return given if is_file(given) else None

    def find(self, source: str | Path) -> Path:
        """Returns the file of a name or a path.

        Raises:
            WrongUse: Of the class `raises`: there is no such name or path; lists the names.
        """
        found = self.file(source)
        if found is None:
            names = self.names()
            raise self.raises(
                f"no {self.what} named {shown(source)!r}; {guess(source, names)}Shipped are "
                f"{', '.join(names) or 'none'}; the path of {self.path} will do too"
            )
        return found
