"""Which files a submission may hold: text, and weights that are read without running code; so many and so large."""

import io
import re
import zipfile
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Final

import numpy as np

from overcooked_bench.files import FileError, read_regular
from overcooked_bench.leaderboard.submission.names import collisions, path_problem

MOST_FILES: Final = 2_000
MOST_BYTES: Final = 256 << 20
"""Bytes of all files together."""

MOST_WEIGHTS: Final = 128 << 20
"""Bytes of a file of weights."""

MOST_TEXT: Final = 1 << 20
"""Bytes of any other file."""

_TEXT: Final = (".py", ".yaml", ".yml", ".json", ".toml", ".csv", ".txt", ".md")
_WEIGHTS: Final = (".safetensors", ".npy", ".npz")
_PLAIN_NAMES: Final = ("LICENSE", "LICENCE", "NOTICE", "COPYING", "README")
_HEAD: Final = 16_384  # bytes, the most of a header of an array
_MOST_ARRAYS: Final = 10_000
_CENTRAL: Final = b"PK\x01\x02"  # one of them for each file of a zip

_ARRAYS: Final = "write arrays with numpy.savez or safetensors, without objects"
_PICKLE: Final = f"a pickle, which can run any code when it is read; {_ARRAYS}"
_TORCH: Final = "a pickle of torch; write the tensors with safetensors.torch.save_file"
_ARCHIVE: Final = "an archive; put its files into the folder, or, of stable-baselines3, use `overcooked-bench export`"
_COMPILED: Final = "compiled code, which nobody can review; leave it out"
_INSTEAD: Final = {
    **dict.fromkeys((".pkl", ".pickle", ".joblib", ".dill"), _PICKLE),
    **dict.fromkeys((".pt", ".pth", ".ckpt", ".bin"), _TORCH),
    **dict.fromkeys((".zip", ".gz", ".tar", ".tgz", ".bz2", ".xz", ".7z", ".zst"), _ARCHIVE),
    **dict.fromkeys((".so", ".pyd", ".dll", ".dylib", ".exe", ".o", ".a", ".pyc", ".whl"), _COMPILED),
}
_FIRST_BYTES: Final = (
    (re.compile(rb"\x80[\x02-\x05]"), _PICKLE),
    (re.compile(rb"PK\x03\x04"), _ARCHIVE),
    (re.compile(rb"\x1f\x8b|BZh\d1AY|\xfd7zXZ"), _ARCHIVE),
    (re.compile(rb"\x7fELF|MZ[^ -~]|\xcf\xfa\xed\xfe|\xca\xfe\xba\xbe"), _COMPILED),
)


def file_problems(files: Mapping[str, Path]) -> list[str]:
    """Lists what is wrong with the files of a submission.

    Args:
        files: By their paths within it.

    Returns:
        Messages that begin with the file and say what to do.
    """
    if len(files) > MOST_FILES:
        return [f"{len(files):,} files; at most {MOST_FILES:,} are allowed: put weights into fewer files"]
    found = [f"{path!a}: {problem}" for path in files if (problem := path_problem(path))] + collisions(files)
    total = 0
    for path, file in files.items():
        if file.is_symlink():
            found.append(f"{path}: a link; put the file itself there")
            continue
        total += file.stat().st_size
        if problem := _problem(file):
            found.append(f"{path}: {problem}")
    if total > MOST_BYTES:
        found.append(f"{total:,} bytes in all; at most {MOST_BYTES:,} are allowed: store float16, or fewer weights")
    return found


def _problem(file: Path) -> str:
    suffix, size = file.suffix.lower(), file.stat().st_size
    if suffix in _INSTEAD:
        return _INSTEAD[suffix]
    if suffix not in (*_TEXT, *_WEIGHTS) and file.name not in _PLAIN_NAMES:
        kinds = ", ".join((*_TEXT, *_WEIGHTS))
        return f"not a kind of file that is accepted ({kinds}, {', '.join(_PLAIN_NAMES)}); convert it or leave it out"
    most = MOST_WEIGHTS if suffix in _WEIGHTS else MOST_TEXT
    if size > most:
        return f"{size:,} bytes; at most {most:,} are allowed for a file of this kind"
    try:
        data = read_regular(file, most)
    except FileError as error:
        return str(error)
    if suffix == ".safetensors":
        return _safetensors(data)
    if suffix == ".npy":
        return _array(data[:_HEAD])
    if suffix == ".npz":
        return _arrays(data)
    return next((instead for first, instead in _FIRST_BYTES if first.match(data)), "")


def _safetensors(data: bytes) -> str:
    from safetensors import SafetensorError, deserialize

    try:
        deserialize(data)  # type: ignore[no-untyped-call]
    except (SafetensorError, ValueError) as error:
        return f"not a safetensors file ({error}); write it with safetensors.numpy.save_file or safetensors.torch"
    return ""


def _array(head: bytes) -> str:
    """Reads the header of a .npy file, which is never unpickled."""
    opened = io.BytesIO(head)
    try:
        version = np.lib.format.read_magic(opened)
        read = {(1, 0): np.lib.format.read_array_header_1_0, (2, 0): np.lib.format.read_array_header_2_0}[version]
        kind = read(opened)[2]
    except (ValueError, KeyError, EOFError, SyntaxError, TypeError) as error:
        return f"not an array of numpy ({error}); {_ARRAYS}"
    return _PICKLE if kind.hasobject else ""


def _arrays(data: bytes) -> str:
    """Reads the headers of all arrays of a .npz file, a few bytes each."""
    if data.count(_CENTRAL) > _MOST_ARRAYS:
        return f"more than {_MOST_ARRAYS:,} arrays; {_ARRAYS}, in fewer arrays"
    try:
        with zipfile.ZipFile(io.BytesIO(data)) as whole:
            for info in whole.infolist():
                with whole.open(info) as member:
                    if problem := _array(member.read(_HEAD)):
                        return f"{info.filename!a}: {problem}"
    except (zipfile.BadZipFile, zlib.error, NotImplementedError, RuntimeError, OSError, EOFError) as error:
        return f"not a file of numpy.savez ({error}); {_ARRAYS}"
    return ""
