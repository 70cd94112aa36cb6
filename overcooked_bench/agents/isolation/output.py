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
        self._poll = select.poll()
        self._poll.register(file, select.POLLIN)
        os.set_blocking(file, False)

    def wait(self, link: socket.socket, seconds: float) -> bool:
        """Waits until a socket has something to read, and reads what is printed meanwhile.

        Returns:
            Whether it has.
        """
        number, left, until = link.fileno(), seconds, time.monotonic() + seconds
        self._poll.register(number, select.POLLIN)
        try:
            while True:
                ready = self._poll.poll(max(0.0, left) * 1000)
                if any(file == self._file for file, _ in ready) and not self._read():
                    self.close()
                if any(file == number for file, _ in ready):
                    return True
                left = until - time.monotonic()
                if left <= 0.0:
                    return False
        finally:
            self._poll.unregister(number)

    def close(self) -> None:
        """Reads no more."""
        if self._file >= 0:
            self._poll.unregister(self._file)
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
