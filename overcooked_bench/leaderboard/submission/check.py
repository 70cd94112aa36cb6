"""Checks a submission without playing it, and packs what is in order."""

import hashlib
import os
import tempfile
from pathlib import Path
from typing import Final

import msgspec

from overcooked_bench.agents.submissions.content import ENTRY, content, hash_submission
from overcooked_bench.documents import LONGEST
from overcooked_bench.files import FileError, read_regular, read_text, shown, write_whole
from overcooked_bench.leaderboard.submission.archive import SUFFIX, pack_files, read_archive, write_files
from overcooked_bench.leaderboard.submission.code import code_problems
from overcooked_bench.leaderboard.submission.files import MOST_FILES, MOST_TEXT, file_problems
from overcooked_bench.leaderboard.submission.manifest import MANIFEST, Manifest, SubmissionError, parse_manifest

_START: Final = "`overcooked-bench submission new NAME` writes one to start from"


class Checked(msgspec.Struct, frozen=True, kw_only=True):
    """What a check found.

    Attributes:
        path: The folder or archive.
        sound: Whether nothing has to be changed.
        problems: Everything that has to be changed, with file and line and what to write instead.
        manifest: What submission.yaml says; None if it has problems.
        sha256: Hash of all files, the one that scores name; None if the files themselves have problems.
        archive_sha256: Hash of the archive; None for a folder.
        files: Number of files.
        bytes: Their size.
    """

    path: str
    sound: bool
    problems: tuple[str, ...]
    manifest: Manifest | None
    sha256: str | None
    archive_sha256: str | None
    files: int
    bytes: int


class Packed(msgspec.Struct, frozen=True, kw_only=True):
    """An archive that was written.

    Attributes:
        archive: Its path.
        archive_sha256: Its hash.
        sha256: Hash of the files in it, the one that scores name.
        bytes: Its size.
    """

    archive: str
    archive_sha256: str
    sha256: str
    bytes: int


def check_submission(path: str | Path) -> Checked:
    """Checks a submission: its manifest, its code as text, and the names, kinds and sizes of its files.

    Args:
        path: A folder, or an archive that `pack` wrote.

    Raises:
        SubmissionError: There is no such folder or file, or an archive is refused as a whole.
    """
    if os.path.isdir(path):
        return _check_folder(Path(path), str(path), None)
    if not os.path.lexists(path):
        raise SubmissionError(f"{shown(path)}: no such folder or archive; {_START}")
    files = read_archive(path)
    with tempfile.TemporaryDirectory() as home:
        folder = Path(home, "submission")
        write_files(files, folder)
        packed = hashlib.sha256(pack_files(files)).hexdigest()
        return _check_folder(folder, str(path), packed)


def pack(folder: str | Path, output: str | Path = ".") -> tuple[Checked, Packed | None]:
    """Packs a submission into `<its name>.submission.zip`; the same files give the same bytes.

    Args:
        folder: The submission.
        output: The folder to write to; it is made.

    Returns:
        What the check found; and the archive, None if there are problems.

    Raises:
        SubmissionError: There is no such folder, or `output` is inside it.
    """
    if not os.path.isdir(folder):
        raise SubmissionError(f"{shown(folder)}: no such folder; {_START}")
    if Path(output).resolve().is_relative_to(Path(folder).resolve()):
        raise SubmissionError(f"{shown(output)}: inside the submission, which it would change; name another --output")
    checked = check_submission(folder)
    if checked.manifest is None or not checked.sound:
        return checked, None
    files = {name: read_regular(file, file.stat().st_size) for name, file in content(folder, False).items()}
    data = pack_files(files)
    Path(output).mkdir(parents=True, exist_ok=True)
    place = Path(output, checked.manifest.name + SUFFIX)
    write_whole(place, data)
    assert checked.sha256 is not None
    sha256 = hashlib.sha256(data).hexdigest()
    return checked, Packed(archive=str(place), archive_sha256=sha256, sha256=checked.sha256, bytes=len(data))


def _check_folder(folder: Path, shown_as: str, archive_sha256: str | None) -> Checked:
    files = content(folder, follow_links=False)
    in_files = file_problems(files)
    manifest, problems = _manifest(files)
    problems += _code(files, manifest)
    few, linked = len(files) <= MOST_FILES, any(file.is_symlink() for file in files.values())
    return Checked(
        path=shown_as,
        sound=not problems and not in_files,
        problems=(*problems, *in_files),
        manifest=manifest,
        sha256=hash_submission(folder) if few and not linked else None,
        archive_sha256=archive_sha256,
        files=len(files),
        bytes=sum(file.lstat().st_size for file in files.values()),
    )


def _manifest(files: dict[str, Path]) -> tuple[Manifest | None, list[str]]:
    if MANIFEST not in files or files[MANIFEST].is_symlink():
        return None, [f"{MANIFEST}: missing; {_START}"]
    try:
        return parse_manifest(read_text(files[MANIFEST], 4 * LONGEST, raises=SubmissionError).lstrip("\ufeff"))
    except SubmissionError as error:
        return None, [str(error).replace(str(files[MANIFEST]), MANIFEST)]


def _code(files: dict[str, Path], manifest: Manifest | None) -> list[str]:
    if ENTRY not in files or files[ENTRY].is_symlink():
        return [f"{ENTRY}: missing; write the Python file that defines make_agent(layout, training_seed)"]
    try:
        return code_problems(read_regular(files[ENTRY], MOST_TEXT), manifest.training_seeds if manifest else None)
    except FileError:
        return []  # `file_problems` says that it is too large
