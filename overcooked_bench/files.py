"""Reads and writes files safely, even if they are damaged, hostile or interrupted."""

import os
import re
import stat
from pathlib import Path
from typing import Final

from overcooked_bench.errors import WrongUse

NAME: Final = r"[A-Za-z0-9][A-Za-z0-9_.-]{0,99}"
"""The form of names that become part of a path: they cannot leave their folder, nor be hidden in it."""

_PART: Final = 1 << 20  # bytes


class FileError(WrongUse):
    """A file cannot be read; the message names it."""


def read_regular(
    path: str | Path, most_bytes: int, *, raises: type[WrongUse] = FileError, follow_links: bool = True
) -> bytes:
    """Reads a regular file, without waiting for a device or filling the memory.

    Args:
        path: The file.
        most_bytes: Greatest size that is read.
        raises: The class of the errors.
        follow_links: Whether the path may be a symbolic link.

    Raises:
        WrongUse: Of the class `raises`: the file is missing, unreadable, too large, or a folder, pipe or device.
    """
    flags = os.O_RDONLY | getattr(os, "O_BINARY", 0) | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_NOCTTY", 0)
    if not follow_links:
        if os.path.islink(path):
            raise raises(f"{shown(path)}: a symbolic link, which is not followed here; copy the file itself")
        flags |= getattr(os, "O_NOFOLLOW", 0)
    try:
        file = os.open(path, flags)
    except FileNotFoundError:
        raise raises(f"{shown(path)}: cannot be read (no such file)") from None
    except (OSError, ValueError) as error:
        raise raises(f"{shown(path)}: cannot be read ({_reason(error)})") from None
    try:
        if not stat.S_ISREG(os.fstat(file).st_mode):
            raise raises(f"{shown(path)}: cannot be read (a folder, a pipe or a device; give a regular file)")
        parts, left = [], most_bytes + 1
        while left and (part := os.read(file, min(left, _PART))):
            parts.append(part)
            left -= len(part)
    except OSError as error:
        raise raises(f"{shown(path)}: cannot be read ({_reason(error)})") from None
    finally:
        os.close(file)
    if not left:
        raise raises(f"{shown(path)}: larger than {most_bytes:,} bytes, the most that is read here")
    return b"".join(parts)


def read_text(path: str | Path, most_bytes: int, *, raises: type[WrongUse] = FileError) -> str:
    r"""Reads a regular file as UTF-8, with `\n` at the end of every line; see `read_regular`.

    Raises:
        WrongUse: Of the class `raises`: it cannot be read, or is not UTF-8.
    """
    try:
        text = read_regular(path, most_bytes, raises=raises).decode("utf-8")
    except UnicodeDecodeError as error:
        raise raises(f"{shown(path)}: not a text file in UTF-8 ({error.reason}); save it as UTF-8") from None
    return text.replace("\r\n", "\n").replace("\r", "\n")


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


def append_line(file: str | Path, line: bytes) -> None:
    """Adds a line to a file, which is on the disk when this returns.

    Args:
        file: Made if it is missing; its folder must exist.
        line: Without its end.
    """
    with Path(file).open("ab") as opened:
        opened.write(line + b"\n")
        opened.flush()
        os.fsync(opened.fileno())


def cut_unfinished_line(file: str | Path) -> None:
    """Cuts off what a program that was killed in `append_line` has left at the end of a file, if there is one."""
    if not os.path.exists(file):
        return
    with Path(file).open("rb+") as opened:
        end = opened.seek(0, os.SEEK_END)
        while end > 0:
            begin = max(0, end - _PART)
            opened.seek(begin)
            last = opened.read(end - begin).rfind(b"\n")
            if last >= 0:
                end = begin + last + 1
                break
            end = begin
        opened.truncate(end)


def check_name(name: str, what: str, raises: type[WrongUse] = FileError) -> str:
    """Returns a name from a file if it can safely become part of a path.

    Args:
        name: As the file says.
        what: The thing that is named, for the message: "manifest.json: the pool's name".
        raises: The class of the error.

    Raises:
        WrongUse: Of the class `raises`: the name holds `/`, `..` or anything else but letters, digits, `.`, `_`, `-`.
    """
    if not re.fullmatch(NAME, name):
        raise raises(
            f"{what} is {shown(name)!r}; use at most 100 letters, digits and . _ -, beginning with a letter or digit"
        )
    return name


def is_file(path: str | Path) -> bool:
    """Returns whether a path leads to a file; False for text that cannot be a path."""
    return os.path.isfile(path)


def shown(text: object, most: int = 200) -> str:
    """Returns a text that messages can print: shortened if it is long, with control characters escaped."""
    whole = str(text)
    cut = whole if len(whole) <= most else whole[: most - 1] + "…"
    return "".join(c if c.isprintable() else c.encode("unicode_escape").decode() for c in cut)


def printable(text: object) -> str:
    """Returns a text that a terminal can print: control characters are escaped, line breaks kept."""
    return "".join(c if c.isprintable() or c == "\n" else repr(c)[1:-1] for c in str(text))


def _reason(error: Exception) -> str:
    return (error.strerror if isinstance(error, OSError) else None) or str(error)
