"""Pages of results that a command writes again, with a part at the end that people write and the command keeps."""

from pathlib import Path
from typing import Final

KEPT: Final = "<!-- Written by hand; the command keeps what follows. -->"
_AT_FIRST: Final = f"{KEPT}\n\n## What falls short\n"


def with_part_by_hand(page: Path, text: str) -> str:
    """Returns a page's new text, followed by the part by hand that it has already.

    Args:
        page: Its file; may be missing.
        text: What is computed.
    """
    before = page.read_text("utf-8") if page.exists() else ""
    by_hand = before[before.index(KEPT) :] if KEPT in before else _AT_FIRST
    return f"{text}\n{by_hand}"
