"""The page of the environments, from the docstring of their class."""

import inspect
import re
from collections.abc import Iterator
from typing import Final

from overcooked_bench.envs.single import OvercookedEnv

PAGE: Final = "reference/environments.md"


def pages() -> Iterator[tuple[str, str]]:
    """Yields the page and its text."""
    text = inspect.getdoc(OvercookedEnv) or ""
    description, _, rest = text.partition("\nArgs:\n")
    arguments, _, after = rest.partition("\n\n")
    joined = re.sub(r"\n {8,}", " ", arguments)
    history = after[after.index("## Version History") :]
    bullets = re.sub(r"^ {4}(\w+): ", r"- `\1`: ", joined, flags=re.MULTILINE)
    yield PAGE, f"# Environments\n\n{description}\n\n{bullets}\n\n{history}\n"
