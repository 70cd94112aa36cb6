"""Pages that stand elsewhere in the repository, such as CONTRIBUTING.md, as pages of the site.

A page of `docs` that consists of an `include` of such a file shows it, and links between the two kinds of pages lead
to each other both on the site and where the repository is read as it is.
"""

import posixpath
import re
from pathlib import Path
from typing import Final

PAGES: Final = {
    "CHANGELOG.md": "docs/changelog.md",
    "CONTRIBUTING.md": "docs/contributing.md",
    "SECURITY.md": "docs/security.md",
    "baselines/results": "docs/results/index.md",
    "baselines/results/dev-v1.md": "docs/results/dev-v1.md",
    "baselines/results/human.md": "docs/results/human.md",
    "baselines/results/humans-plan.md": "docs/results/humans-plan.md",
    "baselines/results/methods.md": "docs/results/methods.md",
    "baselines/results/train-v1.md": "docs/results/train-v1.md",
    "baselines/results/v1-entries.md": "docs/results/v1-entries.md",
    "baselines/results/v1.md": "docs/results/v1.md",
    "baselines/results/with-people.md": "docs/results/with-people.md",
    "tests/benchmarks/RESULTS.md": "docs/results/speed.md",
}
"""File or folder of the repository -> page that shows it."""

_INCLUDE: Final = re.compile(r"```\{include\} (\S+)\n```")
_LINK: Final = re.compile(r"(\]\()([^)\s#]+)((?:#[^)\s]*)?\))")
_COPIED: Final = re.compile(r"\[([^\]]*)\]\((leaderboard/[^)\s]*)\)")
"""Links to pages that are copied into the site as they are; Sphinx would copy the one page alone."""


def expanded(text: str, page: str, root: Path) -> str:
    """Returns a page's text with the file that it includes, and with its links leading to pages of the site.

    Args:
        text: What the page's file says.
        page: The page's path in the repository, such as `docs/security.md`.
        root: The repository.
    """
    found = _INCLUDE.fullmatch(text.strip())
    if not found:
        return relinked(text, page, page)
    file = _join(page, found[1])
    return relinked((root / file).read_text("utf-8"), file, page)


def relinked(text: str, file: str, page: str) -> str:
    """Rewrites the links of a file for the page that shows it.

    Args:
        text: Markdown.
        file: Where the text stands, as a path in the repository.
        page: The page that shows it.
    """

    def relink(match: re.Match[str]) -> str:
        target = match[2]
        if "://" in target or target.startswith("mailto:"):
            return match[0]
        whole = _join(file, target).rstrip("/")
        return match[1] + posixpath.relpath(PAGES.get(whole, whole), posixpath.dirname(page)) + match[3]

    return _LINK.sub(relink, _COPIED.sub(r'<a href="\2">\1</a>', text))


def without_missing(text: str, folder: Path) -> str:
    """Returns a page's text without the entries of its lists of pages for which there is no page.

    A place in a list may be there before the page is.
    """

    def present(match: re.Match[str]) -> str:
        return "\n".join(
            line for line in match[0].splitlines() if _is_no_page(line) or (folder / f"{line}.md").is_file()
        )

    return re.sub(r"```\{toctree\}\n(?s:.*?)\n```", present, text)


def _is_no_page(line: str) -> bool:
    return not re.fullmatch(r"[\w/-]+", line)


def _join(file: str, target: str) -> str:
    return posixpath.normpath(posixpath.join(posixpath.dirname(file), target))
