"""Gets the human games of 2019 as they were published: in the source distribution of overcooked-ai 1.1.0."""

import io
import shutil
import subprocess
import sys
import tarfile
import zlib
from collections.abc import Iterator
from gzip import GzipFile
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Final

from overcooked_bench.errors import WrongUse
from overcooked_bench.files import read_regular, shown

PACKAGE: Final = "overcooked-ai 1.1.0"
SHA256: Final = "478bf319274bdb6c5bede8048ee901d088912353111ab85e9fb2bf389c6ccddf"
"""Of the source distribution; no other file is opened."""

FILE: Final = "overcooked_ai-1.1.0.tar.gz"

SETS: Final = ("train", "test")
"""The two sets that its publishers made of the games."""

_MOST_BYTES: Final = 8 << 20
_MOST_UNPACKED: Final = 96 << 20
_LONGEST_WAIT: Final = 600  # seconds
_BY_HAND: Final = (
    "python -m pip download --no-deps --no-binary overcooked-ai overcooked-ai==1.1.0, "
    f"and give the file with --file {FILE}"
)


class DistributionError(WrongUse):
    """The source distribution is not there, or not the one that is wanted."""


def member(name: str) -> str:
    """Returns where in the distribution a set of games is."""
    return f"overcooked_ai-1.1.0/src/overcooked_ai_py/data/human_data/clean_{name}_trials.pickle"


def download() -> bytes:
    """Gets the source distribution with pip, whichever one is there.

    pip runs the package's `setup.py` to learn what it depends on; it checks the hash first, so no other file is run.

    Raises:
        DistributionError: There is no pip, or it did not get the file; says what to run instead.
    """
    tried = "no pip was found"
    with TemporaryDirectory() as folder:
        wish = Path(folder) / "requirements.txt"
        wish.write_text(f"overcooked-ai==1.1.0 --hash=sha256:{SHA256}\n", "utf-8")
        for pip in _pips():
            command = [*pip, "download", "--quiet", "--no-deps", "--no-binary", "overcooked-ai", "--require-hashes"]
            try:
                done = subprocess.run(
                    [*command, "--requirement", str(wish), "--dest", folder],
                    capture_output=True,
                    text=True,
                    errors="replace",
                    timeout=_LONGEST_WAIT,
                )
            except (OSError, subprocess.TimeoutExpired) as error:
                tried = f"{Path(pip[0]).name} did not answer ({error})"
                continue
            if done.returncode == 0:
                return read_file(Path(folder) / FILE)
            said = [line for line in done.stderr.splitlines() if line.strip()]
            tried = f"pip failed: {shown(said[-1]) if said else f'exit code {done.returncode}'}"
    raise DistributionError(f"{PACKAGE} could not be downloaded ({tried}); where the network allows it, run {_BY_HAND}")


def _pips() -> Iterator[list[str]]:
    if find_spec("pip"):
        yield [sys.executable, "-m", "pip"]
    for program, *rest in (["uv", "tool", "run", "pip"], ["pip3"], ["pip"]):
        if found := shutil.which(program):
            yield [found, *rest]


def read_file(path: str | Path) -> bytes:
    """Reads a file, whichever it is; `unpack` checks it.

    Raises:
        DistributionError: It cannot be read, or is far too large.
    """
    return read_regular(path, _MOST_BYTES, raises=DistributionError)


def digest_of(data: bytes) -> str:
    """Returns the SHA-256 of a file's content."""
    return sha256(data).hexdigest()


def unpack(data: bytes, where: str, digest: str | None = None) -> dict[str, bytes]:
    """Takes the pickles of both sets out of the source distribution, in memory.

    Args:
        data: The distribution.
        where: Its name, for messages.
        digest: Its SHA-256; by default `SHA256`.

    Returns:
        The pickles by set.

    Raises:
        DistributionError: It is another file, or a pickle is not in it.
    """
    digest = digest or SHA256
    if (own := digest_of(data)) != digest:
        raise DistributionError(
            f"{shown(where)} has the SHA-256 {own}, and the source distribution of {PACKAGE} has {digest}; "
            f"run {_BY_HAND}"
        )
    try:
        with GzipFile(fileobj=io.BytesIO(data)) as packed:
            unpacked = packed.read(_MOST_UNPACKED + 1)
        if len(unpacked) > _MOST_UNPACKED:
            raise DistributionError(f"{shown(where)} unpacks to more than {_MOST_UNPACKED:,} bytes")
        with tarfile.open(fileobj=io.BytesIO(unpacked), mode="r:") as archive:
            return {name: _content(archive, member(name), where) for name in SETS}
    except (tarfile.TarError, OSError, EOFError, zlib.error) as error:
        raise DistributionError(f"{shown(where)} is not a .tar.gz ({error}); run {_BY_HAND}") from None


def _content(archive: tarfile.TarFile, name: str, where: str) -> bytes:
    try:
        entry = archive.getmember(name)
    except KeyError:
        entry = None
    file = archive.extractfile(entry) if entry is not None and entry.isreg() else None
    if file is None:
        raise DistributionError(f"{shown(where)} does not hold {name}; run {_BY_HAND}")
    return file.read()
