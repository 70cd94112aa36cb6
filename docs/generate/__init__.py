"""Pages of the documentation that are written from files and code of the repository.

`python -m docs.generate` writes them again; a test compares them with what is in the repository.
"""

from collections.abc import Iterator


def all_pages() -> Iterator[tuple[str, str]]:
    """Yields the path below `docs` and the text of every generated page."""
    from docs.generate import commands, data, environments, kitchens, methods, partners

    for module in (commands, data, environments, kitchens, methods, partners):
        yield from module.pages()
