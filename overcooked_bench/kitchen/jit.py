"""Compiles kernels with numba and a reliable cache: keyed by the sources, checked, and optional if read-only."""

# mypy: disable-error-code="no-untyped-call"

import hashlib
import os
import pickle
import sys
import tempfile
from collections.abc import Callable
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, Final, TypeVar

import numba
from numba.core.caching import IndexDataCacheFile

Function = TypeVar("Function", bound=Callable[..., Any])
DISABLED: bool = bool(numba.config.DISABLE_JIT)  # type: ignore[attr-defined]
"""Whether kernels run as plain Python (NUMBA_DISABLE_JIT=1), the oracle of the tests."""

FOLDERS: Final[set[Path]] = set()
"""Where the kernels of this process are cached."""

_SIZE: Final = hashlib.sha256().digest_size


def jit(function: Function) -> Function:
    """Compiles a kernel on first use, releasing the GIL, and caches the compiled code on disk if possible.

    Numba's own cache checks the file of the outermost function only, and would keep old code when an inlined kernel
    of another file changes. This one is in a folder named after the content of the kitchen's sources, sub-folders
    included, and of the files in the kernel's folder.
    """
    folder = _cache_folder(Path(function.__code__.co_filename).parent)
    options: dict[str, Any] = {"nogil": True, "error_model": "numpy", "_nrt": False}
    if folder is None or DISABLED:
        return numba.njit(**options)(function)  # type: ignore[no-any-return]
    FOLDERS.add(folder)
    before = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    # Read when the function is decorated, never later.
    numba.config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    try:
        kernel = numba.njit(cache=True, **options)(function)
        cache, impl = kernel._cache, kernel._cache._impl
        cache._cache_file = CheckedFiles(cache.cache_path, impl.filename_base, impl.locator.get_source_stamp())
        return kernel  # type: ignore[no-any-return]
    finally:
        numba.config.CACHE_DIR = before  # type: ignore[attr-defined]


@cache
def _cache_folder(beside: Path) -> Path | None:
    digest = hashlib.sha256(numba.__version__.encode())
    for path in sorted({*Path(__file__).parent.rglob("*.py"), *beside.glob("*.py")}):
        digest.update(path.read_bytes())
    if sys.platform == "win32":
        home = os.environ.get("LOCALAPPDATA")
    else:
        home = os.environ.get("XDG_CACHE_HOME") or (
            os.path.join(os.environ["HOME"], ".cache") if "HOME" in os.environ else None
        )
    choices = [
        os.environ.get("NUMBA_CACHE_DIR"),
        os.path.join(Path(__file__).parent, "__pycache__"),
        home and os.path.join(home, "overcooked_bench"),
    ]
    for base in choices:
        if not base:
            continue
        folder = Path(base) / f"kernels-{digest.hexdigest()[:12]}"
        try:
            folder.mkdir(parents=True, exist_ok=True)
            with tempfile.TemporaryFile(dir=folder):
                return folder
        except OSError:
            continue
    return None


class CheckedFiles(IndexDataCacheFile):
    """Numba's index and data files with a checksum: a damaged one counts as absent, and its code is compiled again."""

    def save(self, key: Any, data: Any) -> None:
        """Saves compiled code, or does without where that is impossible."""
        with suppress(OSError):
            super().save(key, data)

    def _load_index(self) -> dict[Any, str]:
        try:
            version, stamp, overloads = self._read(self._index_path)
        except (OSError, ValueError, TypeError):
            return {}
        fresh = version == self._version and stamp == self._source_stamp and isinstance(overloads, dict)
        return overloads if fresh else {}

    def _save_index(self, overloads: dict[Any, str]) -> None:
        self._write(self._index_path, (self._version, self._source_stamp, overloads))

    def _load_data(self, name: str) -> Any:
        return self._read(self._data_path(name))

    def _save_data(self, name: str, data: Any) -> None:
        self._write(self._data_path(name), data)

    def _write(self, path: str, value: Any) -> None:
        data = self._dump(value)
        with self._open_for_write(path) as file:
            file.write(hashlib.sha256(data).digest() + data)

    def _read(self, path: str) -> Any:
        """Reads a file that `_write` wrote.

        Raises:
            OSError: It is missing or damaged; Numba takes that for a file that is not there.
        """
        content = Path(path).read_bytes()
        if hashlib.sha256(content[_SIZE:]).digest() != content[:_SIZE]:
            raise OSError(f"{path} is damaged")
        return pickle.loads(content[_SIZE:])
