"""Compiles kernels with numba and a reliable cache: keyed by the sources, and optional if nothing can be written."""

import hashlib
import os
import sys
import tempfile
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any, TypeVar

import numba

from overcooked_bench.kitchen.compiled_files import keep_checked

Function = TypeVar("Function", bound=Callable[..., Any])
DISABLED: bool = bool(numba.config.DISABLE_JIT)  # type: ignore[attr-defined]
"""Whether kernels run as plain Python (NUMBA_DISABLE_JIT=1), the oracle of the tests."""


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
    before = numba.config.CACHE_DIR  # type: ignore[attr-defined]
    # Read when the function is decorated, never later.
    numba.config.CACHE_DIR = str(folder)  # type: ignore[attr-defined]
    try:
        kernel = numba.njit(cache=True, **options)(function)
        keep_checked(kernel._cache)
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
