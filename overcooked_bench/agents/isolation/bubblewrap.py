"""Sandboxes of bubblewrap (`bwrap`): a read-only file system with Python and the submission alone, and no network."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable, Iterator
from functools import cache
from importlib.util import find_spec
from pathlib import Path
from typing import Final

SCRATCH: Final = "/scratch"
"""The sandbox's folder for temporary files, in memory."""

_SYSTEM: Final = ("/bin", "/sbin", "/lib", "/lib32", "/lib64", "/libx32")  # links into /usr on most systems
_READ: Final = ("/usr", "/nix/store", "/gnu/store", "/etc/ld.so.cache", "/etc/alternatives", "/etc/localtime")
_HIDDEN: Final = ("pools", "entries")
_PAGE: Final = "4096"
_PATIENCE: Final = 60.0  # seconds


def command(visible: Iterable[Path], scratch_bytes: int) -> list[str]:
    """Returns the arguments of bwrap before the program that is to run.

    Args:
        visible: Files that it can read, besides those of Python and its packages.
        scratch_bytes: Size of `SCRATCH`, the only place where it can write.

    The program is the first process of the sandbox; otherwise it would be one of bwrap's, whose memory the submission
    could change.
    """
    words = ["--unshare-all", "--unshare-user", "--disable-userns", "--die-with-parent", "--new-session"]
    words += ["--as-pid-1", "--cap-drop", "ALL", "--hostname", "sandbox"]
    for place in _SYSTEM:
        if os.path.islink(place):
            words += ["--symlink", os.readlink(place), place]
        elif os.path.isdir(place):
            words += ["--ro-bind", place, place]
    bound = list(_without_nested([*(place for place in _READ if os.path.exists(place)), *_python()]))
    for place in bound:
        words += ["--ro-bind", place, place]
    for place in _hidden(bound):
        words += ["--size", _PAGE, "--tmpfs", place, "--remount-ro", place]
    words += ["--proc", "/proc", "--dev", "/dev", "--remount-ro", "/dev"]
    words += ["--size", str(scratch_bytes), "--tmpfs", SCRATCH]
    for file in visible:
        words += ["--ro-bind", str(file), str(file)]
    return [*words, "--remount-ro", "/", "--chdir", SCRATCH]


@cache
def missing() -> str:
    """Says why sandboxes cannot be made here; an empty text if they can."""
    program = shutil.which("bwrap")
    if program is None:
        return "bubblewrap is not installed"
    trial = [program, *command((), 1 << 20), sys.executable, "-I", "-c", "import overcooked_bench"]
    try:
        done = subprocess.run(trial, stdin=subprocess.DEVNULL, capture_output=True, timeout=_PATIENCE, env={})
    except (OSError, subprocess.TimeoutExpired) as error:
        return f"bubblewrap does not start ({type(error).__name__})"
    said = done.stderr.decode("utf-8", "replace").strip().splitlines()
    return f"bubblewrap does not work ({said[-1][:200] if said else done.returncode})" if done.returncode else ""


def _python() -> Iterator[str]:
    """Yields the folders of Python, its packages and this one."""
    yield from {sys.prefix, sys.base_prefix, sys.exec_prefix, sys.base_exec_prefix}
    program = Path(sys.executable)
    while True:  # a virtual environment has a link to a program that may be a link, too
        yield str(program.parent)
        if not program.is_symlink():
            break
        program = program.parent / program.readlink()
    yield str(program.resolve().parent.parent)
    spec = find_spec("overcooked_bench")
    yield from (spec.submodule_search_locations or ()) if spec else ()


def _without_nested(places: Iterable[str]) -> Iterator[str]:
    """Yields places by length, without those that are in one of the others."""
    found: list[str] = []
    for place in sorted({os.path.abspath(place) for place in places}, key=lambda place: (len(place), place)):
        if not any(place == other or place.startswith(other.rstrip("/") + "/") for other in found):
            found.append(place)
            yield place


def _hidden(bound: list[str]) -> Iterator[str]:
    """Yields the folders of shipped pools and entries, where they can be seen."""
    spec = find_spec("overcooked_bench.baselines")
    for home in (spec.submodule_search_locations or ()) if spec else ():
        for name in _HIDDEN:
            place = os.path.abspath(os.path.join(home, name))
            if os.path.isdir(place) and any(place.startswith(other.rstrip("/") + "/") for other in bound):
                yield place
