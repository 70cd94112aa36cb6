"""Files of compiled code with a checksum: what is damaged counts as absent, and is compiled again."""

# mypy: disable-error-code="no-untyped-call"

import hashlib
import pickle
from contextlib import suppress
from pathlib import Path
from typing import Any, Final

from numba.core.caching import IndexDataCacheFile

_SIZE: Final = hashlib.sha256().digest_size


def keep_checked(cache: Any) -> None:
    """Makes the cache of a kernel, as Numba has just made it, keep its files with checksums."""
    impl = cache._impl
    cache._cache_file = CheckedFiles(cache.cache_path, impl.filename_base, impl.locator.get_source_stamp())


class CheckedFiles(IndexDataCacheFile):
    """An index and its data files, each a SHA-256 and a pickle of this machine's own making."""

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
