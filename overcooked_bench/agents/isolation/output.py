"""Reads what a submission prints: the first part is shown, and the rest is left out."""

import os
import select
import socket
import sys
import time
from contextlib import suppress
from typing import Final

_MOST_SHOWN: Final = 20_000
"""Bytes that are shown."""
_PART: Final = 1 << 16
_CUT: Final = "\n(what the submission prints from here on is left out)\n"


class Output:
    """The standard output and standard error of a submission's processes.

    Args:
        file: Where to read it; closed by `close`.
    """

    def __init__(self, file: int) -> None:
        self._file = file
        self._left = _MOST_SHOWN
        os.set_blocking(file, False)

    def wait(self, link: socket.socket, seconds: float) -> bool:
        """Waits until a socket has something to read, and reads what is printed meanwhile.

        Returns:
            Whether it has.
        """
        poll, until = select.poll(), time.monotonic() + seconds
        poll.register(link, select.POLLIN)
        if self._file >= 0:
            poll.register(self._file, select.POLLIN)
        while True:
            left = until - time.monotonic()
            ready = dict(poll.poll(max(0.0, left) * 1000))
            if self._file in ready and not self._read():
                poll.unregister(self._file)
                self.close()
            if link.fileno() in ready:
                return True
            if left <= 0.0:
                return False

    def close(self) -> None:
        """Reads no more."""
        if self._file >= 0:
            os.close(self._file)
            self._file = -1

    def drain(self) -> None:
        """Shows what is left where nobody prints any more."""
        with suppress(BlockingIOError):
            while self._file >= 0 and self._read() and self._left > 0:
                pass

    def _read(self) -> bool:
        """Reads a part; returns whether there may be more."""
        part = os.read(self._file, _PART)
        if part and self._left > 0:
            text = part[: self._left].decode("utf-8", "replace")
            self._left -= len(part)
            text += _CUT if self._left <= 0 else ""
            sys.stderr.write("".join(c if c.isprintable() or c == "\n" else _escaped(c) for c in text))
        return bool(part)


def _escaped(character: str) -> str:
    return character.encode("unicode_escape").decode()
