"""Lets a submission import modules of its folder, without a trace in the rest of the process."""

import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any, Final

PREFIX: Final = "overcooked_bench_submission_"
"""Prefix of the names of submissions' own modules."""


class Imports:
    """The modules in a submission's folder.

    Two submissions may both have a `helper.py`: while one's code runs, its own helpers are in `sys.modules`, and
    other modules of the same names are not.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._own: dict[str, ModuleType] = {}

    @contextmanager
    def open(self) -> Iterator[None]:
        """Makes its modules importable, and hides other modules of the same names."""
        folder, before = str(self._folder), dict(sys.modules)
        no_bytecode, sys.dont_write_bytecode = sys.dont_write_bytecode, True
        beside = self._names() - set(sys.stdlib_module_names)
        for name in before:
            top = name.partition(".")[0]
            if top in beside and not self._lies_here(before.get(top)):
                del sys.modules[name]
        sys.modules.update(self._own)
        sys.path.insert(0, folder)
        try:
            yield
        finally:
            sys.dont_write_bytecode = no_bytecode
            if folder in sys.path:
                sys.path.remove(folder)
            found = dict(sys.modules)
            tops = {name for name in found if found[name] is not before.get(name) and self._lies_here(found[name])}
            self._own = {name: module for name, module in found.items() if name.partition(".")[0] in tops}
            for name in self._own:
                del sys.modules[name]
            sys.modules.update({name: module for name, module in before.items() if name not in sys.modules})

    def _names(self) -> set[str]:
        files = {file.stem for file in self._folder.glob("*.py")}
        return files | {package.parent.name for package in self._folder.glob("*/__init__.py")}

    def _lies_here(self, module: Any) -> bool:
        """Returns whether a module is a file or a package directly in the folder (and not a submission itself)."""
        if str(getattr(module, "__name__", "")).startswith(PREFIX):
            return False
        told = getattr(module, "__dict__", {})  # some libraries' modules return something for any attribute
        homes = [str(path) for path in told.get("__path__") or ()] or [str(told.get("__file__") or "")]
        return any(Path(home).parent == self._folder for home in homes)
