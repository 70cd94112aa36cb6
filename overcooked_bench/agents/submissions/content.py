"""Finds the files of a submission, whose content is in its hash.

A folder consists of all its files. A single file consists of that file and what it can use in its folder: the modules
that it imports, and every file or folder that a string in its code names, by the whole name or by its suffix (`".npz"`
names all of them). `guard` ensures that a submission opens nothing else there, so no change goes unnoticed.
"""

import ast
import hashlib
import importlib.util
import os
import sys
from collections.abc import Iterable, Iterator
from importlib.machinery import all_suffixes
from pathlib import Path
from typing import Final

ENTRY: Final = "agent.py"

CACHES: Final = (".pyc", ".pyo", ".nbi", ".nbc")
"""Suffixes of compiled code in `__pycache__`, which Python and numba make again from the sources."""

_TOOLS: Final = frozenset(
    {".git", ".hg", ".svn", ".venv", ".tox", ".nox", ".idea", ".vscode", ".DS_Store", ".ipynb_checkpoints"}
    | {".mypy_cache", ".pytest_cache", ".ruff_cache", ".hypothesis"}
)
_EPISODES: Final = "episodes.sqlite"  # is in every folder that a score was written to
_SCORES: Final = "scores"
_LONGEST_NAME: Final = 300


def hash_submission(path: str | Path) -> str:
    """Computes a submission's SHA-256, hexadecimal.

    Args:
        path: A file or a folder. A file that uses no other file has the hash of its content; otherwise every file of
            `content` counts with its name.
    """
    path = Path(path)
    found = content(path)
    if path.is_file() and len(found) == 1:
        return _digest(path)
    whole = hashlib.sha256()
    for name, file in sorted(found.items()):
        whole.update(f"{name}\0{_digest(file)}\n".encode())
    return whole.hexdigest()


def content(path: str | Path, follow_links: bool = True) -> dict[str, Path]:
    """Lists the files of a submission by their names in its folder, such as `weights/w.npz`.

    Left out of a folder are compiled code, folders of tools such as `.git`, `.venv` and `.pytest_cache`, folders in
    `scores/`, and whatever folder a score was written to; a submission cannot open those.

    Args:
        path: A file or a folder.
        follow_links: Whether a folder's links stand for what they lead to; otherwise links are listed themselves.
    """
    path = Path(os.path.abspath(path))
    if path.is_dir():
        return {_name(file, path): file for file in _walk(path, follow_links=follow_links)}
    return {_name(file, path.parent): file for file in sorted({path, *_used(path)})}


def imported_by(path: str | Path) -> set[str]:
    """Lists the modules that a submission's sources import, without the names after the first dot."""
    return {name for file in content(path).values() if file.suffix == ".py" for name in _mentions(file)[0]}


def ours(folder: str | Path) -> tuple[str, ...]:
    """Lists the folders in a submission's folder that belong to Python, its packages or this one.

    These are a virtual environment, or a checkout; each ends with a separator.
    """
    package = importlib.util.find_spec("overcooked_bench")
    homes = [sys.prefix, sys.base_prefix, *(package.submodule_search_locations or () if package else ())]
    for room in ("baselines", "protocols", "unit_scenarios"):
        spec = importlib.util.find_spec(f"overcooked_bench.{room}")
        homes += spec.submodule_search_locations or () if spec else ()
    found = {os.path.abspath(home) for home in homes} | {os.path.realpath(home) for home in homes}
    inside = os.path.abspath(folder).rstrip(os.sep) + os.sep
    return tuple(home.rstrip(os.sep) + os.sep for home in found if home.startswith(inside))


def is_compiled(path: str) -> bool:
    """Returns whether a path is compiled code in a cache."""
    return path.endswith(CACHES) and os.path.basename(os.path.dirname(path)) == "__pycache__"


def _walk(folder: Path, root: Path | None = None, follow_links: bool = True) -> Iterator[Path]:
    """Yields the files of a folder that count, links followed once or yielded themselves."""
    root, seen, homes = root or folder, set[str](), ours(root or folder)
    for home, folders, files in os.walk(folder, followlinks=follow_links):
        place, kept = Path(home), []
        inside = place.relative_to(root).parts
        for name in sorted(folders):
            real = os.path.realpath(place / name)
            score = (*inside[:1], name)[0] == _SCORES and len(inside) == 1
            if name in _TOOLS or score or (follow_links and real in seen) or (real + os.sep).startswith(homes):
                continue
            if not follow_links and os.path.islink(place / name):
                yield place / name
                continue
            if not os.path.isfile(place / name / _EPISODES):
                seen.add(real)
                kept.append(name)
        folders[:] = kept
        for name in sorted(files):
            file = place / name
            counts = file.is_file() or (file.is_symlink() and not follow_links)
            if name not in _TOOLS and not is_compiled(str(file)) and counts:
                yield file


def _used(entry: Path) -> Iterator[Path]:
    """Yields what a single file can use in its folder, and what its modules there can use in turn."""
    folder, waiting, read = entry.parent, [entry], set[Path]()
    beside = [thing for thing in sorted(folder.iterdir()) if thing != entry and thing.name not in _TOOLS]
    while waiting:
        source = waiting.pop()
        if source in read:
            continue
        read.add(source)
        modules, texts = _mentions(source)
        used = [file for module in modules for file in _module(module, folder)]
        names = {part for text in texts for part in text.replace("\\", "/").split("/")}
        for thing in beside:
            if thing.is_dir():
                used += _walk(thing, folder) if thing.name in names else ()
            elif thing.is_file() and thing.suffix == ".py":
                used += [thing] if {thing.name, thing.stem} & names else []
            elif thing.is_file() and (thing.name in names or _ends(texts, thing.suffix)):
                used.append(thing)
        yield from used
        waiting += [file for file in used if file.suffix == ".py"]


def _mentions(source: Path) -> tuple[set[str], set[str]]:
    """Reads the names of modules that a source imports, and the short strings in it."""
    try:
        tree = ast.parse(source.read_bytes())
    except (SyntaxError, ValueError, OSError, RecursionError, MemoryError):  # loading it reports what is wrong
        return set(), set()
    modules, texts = set(), set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            modules |= {alias.name.partition(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module and not node.level:
            modules.add(node.module.partition(".")[0])
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and len(node.value) <= _LONGEST_NAME:
            texts.add(node.value)
    return modules, texts


def _module(name: str, folder: Path) -> list[Path]:
    """Finds the files of a module in the folder, directly or anywhere that Python finds it."""
    found = [folder / (name + suffix) for suffix in all_suffixes()]
    package = folder / name
    if name not in sys.stdlib_module_names and not package.is_dir() and not any(file.is_file() for file in found):
        try:
            spec = importlib.util.find_spec(name)
        except (ImportError, ValueError, AttributeError):
            spec = None
        places = [] if spec is None else [*(spec.submodule_search_locations or ()), spec.origin or ""]
        inside = [Path(os.path.abspath(place)) for place in places if _is_inside(place, folder)]
        found += [place for place in inside if place.suffix]
        package = next((place for place in inside if place.is_dir()), package)
    return [file for file in found if file.is_file()] + (list(_walk(package, folder)) if package.is_dir() else [])


def _is_inside(place: str, folder: Path) -> bool:
    full = os.path.abspath(place)
    return full.startswith(str(folder) + os.sep) and not full.startswith(ours(folder)) and os.path.exists(full)


def _ends(texts: Iterable[str], suffix: str) -> bool:
    return bool(suffix) and any(text.endswith(suffix) for text in texts)


def _name(file: Path, folder: Path) -> str:
    return file.relative_to(folder).as_posix()


def _digest(file: Path) -> str:
    with file.open("rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()
