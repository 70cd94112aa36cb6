"""A packed submission: one zip, without compression, whose every byte follows from names and contents.

Only exactly what `pack_files` writes is read. So an archive cannot unpack to more than its own size, hide anything,
or mean different things to different programs. All is checked before anything is written.

Source of the format: APPNOTE.TXT of PKWARE, 6.3.10, sections 4.3.7, 4.3.12 and 4.3.16.
"""

import os
import stat
import struct
import tempfile
import zlib
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Final

from overcooked_bench.agents.submissions.content import content
from overcooked_bench.files import read_regular, shown
from overcooked_bench.leaderboard.submission.files import MOST_BYTES, MOST_FILES
from overcooked_bench.leaderboard.submission.manifest import SubmissionError
from overcooked_bench.leaderboard.submission.names import LONGEST_PATH, collisions, path_problem

SUFFIX: Final = ".submission.zip"

_FILE, _ENTRY, _END = struct.Struct("<4s5H3I2H"), struct.Struct("<4s6H3I5H2I"), struct.Struct("<4s4H2IH")
_FILE_SIGN, _ENTRY_SIGN, _END_SIGN = b"PK\x03\x04", b"PK\x01\x02", b"PK\x05\x06"
_VERSION: Final = 20
_UNIX: Final = 3 << 8
_DAY: Final = (1 << 5) + 1  # 1 January 1980
_MODE: Final = (stat.S_IFREG | 0o644) << 16
_MOST_ARCHIVE: Final = MOST_BYTES + MOST_FILES * (_FILE.size + _ENTRY.size + 2 * LONGEST_PATH) + _END.size
_OF_SB3: Final = b"_stable_baselines3_version"  # a file in every model that it saves
_AGAIN: Final = "unpack it with a program that you trust, look at the files, and use `overcooked-bench submission pack`"


def pack_files(files: Mapping[str, bytes]) -> bytes:
    """Packs files: the same names and contents give the same bytes.

    Args:
        files: Contents by path within the submission, which `file_problems` has checked.
    """
    whole, entries = bytearray(), bytearray()
    for name in sorted(files):
        data, raw = files[name], name.encode()
        size, crc = len(data), zlib.crc32(data)
        entries += _ENTRY.pack(
            *(_ENTRY_SIGN, _UNIX | _VERSION, _VERSION, 0, 0, 0, _DAY, crc, size, size),
            *(len(raw), 0, 0, 0, 0, _MODE, len(whole)),
        )
        entries += raw
        whole += _FILE.pack(_FILE_SIGN, _VERSION, 0, 0, 0, _DAY, crc, size, size, len(raw), 0) + raw + data
    end = _END.pack(_END_SIGN, 0, 0, len(files), len(files), len(entries), len(whole), 0)
    return bytes(whole + entries + end)


def read_archive(file: str | Path) -> dict[str, bytes]:
    """Reads a packed submission and checks all of it; writes nothing.

    Args:
        file: What `submission pack` wrote, or anything else.

    Returns:
        Contents by path.

    Raises:
        SubmissionError: It is not exactly what `pack_files` writes; says what was found.
    """
    where, data = shown(file), read_regular(file, _MOST_ARCHIVE, raises=SubmissionError)
    if not data.startswith(_FILE_SIGN):
        raise SubmissionError(
            f"{where}: not a packed submission; write one with `overcooked-bench submission pack DIR`"
        )
    try:
        return _read(data)
    except _Refusal as error:
        if _OF_SB3 in data[-2_000:]:
            raise SubmissionError(
                f"{where}: a model of stable-baselines3; make a submission of it with `overcooked-bench export`"
            ) from None
        raise SubmissionError(f"{where}: {error}") from None


def unpack(file: str | Path, folder: str | Path) -> None:
    """Unpacks a submission: all of it, or nothing.

    Args:
        file: The archive.
        folder: Where to; it must not exist.

    Raises:
        SubmissionError: The archive is refused, or the folder exists.
    """
    files, folder = read_archive(file), Path(folder)
    if folder.exists() or folder.is_symlink():
        raise SubmissionError(f"{shown(folder)}: exists already; name a folder that does not")
    folder.absolute().parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder.absolute().parent, prefix=".unpacking-") as home:
        unfinished = Path(home, "submission")
        write_files(files, unfinished)
        os.rename(unfinished, folder)


def unpacked(file: str | Path) -> Path:
    """Returns the folder of an archive's files next to it, `NAME` for `NAME.submission.zip`; unpacks it if need be.

    Raises:
        SubmissionError: The archive is refused, or the folder holds something else.
    """
    file = Path(file)
    folder = file.with_name(file.name.removesuffix(SUFFIX))
    if not folder.exists():
        unpack(file, folder)
    elif {name: place.read_bytes() for name, place in content(folder).items()} != read_archive(file):
        raise SubmissionError(
            f"{shown(folder)}: holds other files than {shown(file)}; move it away, or unpack the archive elsewhere "
            "with `overcooked-bench submission unpack`"
        )
    return folder


def write_files(files: Mapping[str, bytes], folder: Path) -> None:
    """Writes files into a new folder; their paths were checked by `read_archive`."""
    folder.mkdir()
    for path, data in files.items():
        place = folder / path
        place.parent.mkdir(parents=True, exist_ok=True)
        with place.open("xb") as opened:
            opened.write(data)


class _Refusal(Exception):
    """Why an archive is refused."""


def _read(data: bytes) -> dict[str, bytes]:
    files: dict[str, bytes] = {}
    position = 0
    for name, found, end in _contents(data):
        if name in files:
            raise _Refusal(f"{name!a}: twice in the archive; {_AGAIN}")
        if len(files) == MOST_FILES:
            raise _Refusal(f"more than {MOST_FILES:,} files; put weights into fewer files")
        files[name], position = found, end
    _check_kinds(data, position)
    if clash := collisions(files):
        raise _Refusal(clash[0])
    if pack_files(files) != data:
        raise _Refusal(f"not what `submission pack` writes of these files (order, dates, comments or more); {_AGAIN}")
    return files


def _contents(data: bytes) -> Iterator[tuple[str, bytes, int]]:
    """Yields name, content and the end of each file, in the order of the archive."""
    position, total = 0, 0
    while data.startswith(_FILE_SIGN, position):
        if position + _FILE.size > len(data):
            raise _Refusal("it ends in the middle of a file; copy or download it again")
        _, _, flags, method, _, _, crc, _, size, length, extra = _FILE.unpack_from(data, position)
        start = position + _FILE.size + length + extra
        name = _name(data[position + _FILE.size : position + _FILE.size + length])
        if flags & 1:
            raise _Refusal(f"{name!a}: encrypted; {_AGAIN}")
        if method:
            raise _Refusal(f"{name!a}: compressed, which submissions are not; {_AGAIN}")
        if flags & 8:
            raise _Refusal(f"{name!a}: without its size in front; {_AGAIN}")
        total += size
        if total > MOST_BYTES:
            raise _Refusal(f"{name!a}: more than {MOST_BYTES:,} bytes in all; store float16, or fewer weights")
        position = start + size
        found = data[start:position]
        if len(found) != size or zlib.crc32(found) != crc:
            raise _Refusal(f"{name!a}: damaged or cut off; copy or download it again")
        yield name, found, position


def _name(raw: bytes) -> str:
    try:
        name = raw.decode()
    except UnicodeDecodeError:
        raise _Refusal(f"{ascii(raw)[1:]}: a name that is not UTF-8; rename the file and pack again") from None
    if problem := path_problem(name):
        raise _Refusal(f"{shown(name)!a}: {problem}")
    return name


def _check_kinds(data: bytes, position: int) -> None:
    """Refuses links, folders and devices, which the list of contents at the archive's end marks as such."""
    while data.startswith(_ENTRY_SIGN, position) and position + _ENTRY.size <= len(data):
        entry = _ENTRY.unpack_from(data, position)
        length, extra, comment, mode = entry[10], entry[11], entry[12], entry[15] >> 16
        name = data[position + _ENTRY.size : position + _ENTRY.size + length]
        if stat.S_ISLNK(mode):
            raise _Refusal(f"{ascii(name)[1:]}: a link; put the file itself into the folder and pack again")
        if stat.S_IFMT(mode) not in (0, stat.S_IFREG):
            raise _Refusal(f"{ascii(name)[1:]}: a folder, pipe or device; only regular files can be submitted")
        position += _ENTRY.size + length + extra + comment
