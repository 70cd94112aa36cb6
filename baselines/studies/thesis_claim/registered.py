"""What was registered before the study was run: hashes of the plan, the recipe and the code of the analysis."""

import hashlib
from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.documents import LONGEST, read_json
from overcooked_bench.files import read_text, write_whole

from .records import RESULTS
from .study import RECIPE, StudyError

PLAN: Final = "plan.md"
REGISTERED: Final = "registered.json"
DEVIATIONS: Final = "deviations.md"
"""What was done otherwise than planned, written when it was; the result page repeats it."""
_CODE: Final = Path(__file__).parent
_MOST_BYTES: Final = 1_000_000


class Registered(msgspec.Struct, frozen=True):
    """The content of registered.json.

    Attributes:
        plan: SHA-256 of plan.md.
        recipe: SHA-256 of study.yaml.
        code: File of this package -> its SHA-256.
    """

    plan: str
    recipe: str
    code: dict[str, str]

    @property
    def hashes(self) -> tuple[str, str]:
        """The plan's and the recipe's."""
        return self.plan, self.recipe

    @property
    def code_sha256(self) -> str:
        """One hash of all code."""
        lines = "".join(f"{sha256}  {file}\n" for file, sha256 in sorted(self.code.items()))
        return hashlib.sha256(lines.encode()).hexdigest()


def present(home: Path) -> Registered:
    """Hashes what is there now; line ends do not count.

    Raises:
        StudyError: A file cannot be read.
    """
    code = {file.name: _sha256(file) for file in sorted(_CODE.glob("*.py"))}
    return Registered(_sha256(home / PLAN), _sha256(home / RECIPE), code)


def register(home: Path) -> Registered:
    """Writes registered.json.

    Raises:
        StudyError: The study has records already, or a file cannot be read.
    """
    if records := sorted((home / RESULTS).glob("*.json")):
        raise StudyError(f"{records[0]} is there already; what has been run cannot be registered")
    found = present(home)
    write_whole(home / REGISTERED, msgspec.json.format(msgspec.json.encode(found), indent=2) + b"\n")
    return found


def check_registered(home: Path) -> tuple[Registered, list[str]]:
    """Compares what is there with what was registered.

    Returns:
        What was registered, and the files of the code that have changed since.

    Raises:
        StudyError: The plan or the recipe is another one, or nothing was registered.
    """
    known, now = read_json(home / REGISTERED, _MOST_BYTES, Registered, StudyError), present(home)
    for file, theirs, ours in ((PLAN, known.plan, now.plan), (RECIPE, known.recipe, now.recipe)):
        if theirs != ours:
            raise StudyError(
                f"{home / file} is not what was registered (its hash is {ours[:12]}, that in {REGISTERED} is "
                f"{theirs[:12]}); restore it, and write what is done otherwise into {DEVIATIONS}"
            )
    return known, sorted(file for file in {*known.code, *now.code} if known.code.get(file) != now.code.get(file))


def deviations(home: Path) -> str:
    """Returns what was done otherwise than planned; "" if nothing is written down."""
    file = home / DEVIATIONS
    return read_text(file, LONGEST, raises=StudyError).strip() if file.is_file() else ""


def _sha256(file: Path) -> str:
    return hashlib.sha256(read_text(file, LONGEST, raises=StudyError).encode()).hexdigest()
