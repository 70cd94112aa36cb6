"""Docstrings, whose text is Markdown as on every page, as the reStructuredText that Sphinx's autodoc reads."""

import re
from collections.abc import Iterator
from typing import Final

_FENCE: Final = re.compile(r"( *)```(\w*)$")
_CODE: Final = re.compile(r"(`[^`]*`)")


def as_rst(lines: list[str]) -> list[str]:
    """Returns a docstring's lines with fenced code as code blocks, and without the signs of reStructuredText."""
    return [*_converted(lines)]


def _converted(lines: list[str]) -> Iterator[str]:
    inside: str | None = None
    for line in lines:
        fence = _FENCE.match(line)
        if fence and inside is None:
            inside = fence[1]
            yield from (f"{inside}.. code-block:: {fence[2] or 'text'}", "")
        elif fence:
            inside = None
            yield ""
        elif inside is not None:
            yield f"    {line}" if line else ""
        else:
            yield "".join(part if part.startswith("`") else _plain(part) for part in _CODE.split(line))


def _plain(text: str) -> str:
    """Returns text in which a star, a bar and a final underscore mean themselves."""
    return re.sub(r"([*|]|(?<=\w)_(?!\w))", r"\\\1", text)
