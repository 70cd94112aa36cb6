"""Files are written whole or not at all."""

import os
from pathlib import Path


def write_whole(file: str | Path, data: bytes | str) -> None:
    """Writes a file whole or not at all: readers see the old content or the new, never a part.

    Args:
        file: Where to; its folder must exist.
        data: The content; a text is written as UTF-8.
    """
    file = Path(file)
    unfinished = file.with_name(file.name + ".part")
    unfinished.write_bytes(data.encode() if isinstance(data, str) else data)
    os.replace(unfinished, file)
