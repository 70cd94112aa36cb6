"""Messages and shared memory between a submission's process and ours: fixed structs and bytes, never pickles.

A message has one size, and travels as one packet of a socket. Its content, such as observations or an error's text, is
in a frame: memory that both processes map, whose size is sealed. Whatever the submission writes there at whatever time,
reading it gives bytes, which are copied first and then checked.
"""

import fcntl
import mmap
import os
import socket
import struct
from dataclasses import dataclass
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

FACTS: Final = 1
"""Request: load the submission and report what it says about itself."""
MAKE: Final = 2
"""Request: load the submission and make an agent."""
RESET: Final = 3
ACT: Final = 4
STATES: Final = 5
"""Request: act on states."""

DONE: Final = 10
"""Answer: the content is the result."""
DECLINED: Final = 11
"""Answer: UnknownLayout was raised; the content is its text, as that of all further kinds."""
AT_FAULT: Final = 12
"""Answer: the text says all of what is wrong."""
RAISED: Final = 13
"""Answer: the agent's method raised what the text describes."""
GAME: Final = 14
"""Answer: as RAISED, in one row."""
NO_ACTION: Final = 15
"""Answer: `act` did not return one action per row."""

ANSWERS: Final = frozenset({DONE, DECLINED, AT_FAULT, RAISED, GAME, NO_ACTION})

LONGEST_TEXT: Final = 4096
"""Bytes of a text in an answer."""
LEAST: Final = 1 << 16
"""Bytes of the smallest frame."""
MOST: Final = 1 << 30
"""Bytes of the largest frame."""

_FORM: Final = struct.Struct("<BBxxiQQ8s5I")


class Message(NamedTuple):
    """A request, or the answer to one.

    Attributes:
        kind: One of the constants above.
        number: Of the request; an answer has that of its request.
        size: Bytes of the content, which is at the start of the frame.
        row: The row that an error is about, -1 if it is about no single one.
        dtype: Of the observations, as `np.dtype.str` writes it.
        shape: Of the observations, or (B, length of the layout's text) of a reset.
    """

    kind: int
    number: int
    size: int = 0
    row: int = -1
    dtype: str = ""
    shape: tuple[int, ...] = ()

    def pack(self) -> bytes:
        """Returns the packet."""
        dims = (*self.shape, *([0] * (5 - len(self.shape))))
        form = (self.kind, len(self.shape), self.row, self.number, self.size, self.dtype.encode(), *dims)
        return _FORM.pack(*form)

    @classmethod
    def unpack(cls, packet: bytes) -> "Message":
        """Reads a packet.

        Raises:
            ValueError: It has another size, or its text is not ASCII.
        """
        if len(packet) != _FORM.size:
            raise ValueError(f"a message has {_FORM.size} bytes, this one {len(packet)}")
        kind, axes, row, number, size, dtype, *dims = _FORM.unpack(packet)
        return cls(kind, number, size, row, dtype.rstrip(b"\0").decode("ascii"), tuple(dims[:axes]))


PACKET: Final = _FORM.size
"""Bytes of every message."""


@dataclass(frozen=True)
class Frame:
    """Memory that two processes share.

    Attributes:
        memory: The memory.
    """

    memory: mmap.mmap

    @classmethod
    def make(cls, size: int) -> tuple["Frame", int]:
        """Makes a frame of `size` bytes at least, which nobody can shrink; returns its descriptor too."""
        file = os.memfd_create("frame", os.MFD_CLOEXEC | os.MFD_ALLOW_SEALING)
        try:
            capacity = max(LEAST, 1 << (size - 1).bit_length())
            os.ftruncate(file, capacity)
            fcntl.fcntl(file, fcntl.F_ADD_SEALS, fcntl.F_SEAL_SHRINK | fcntl.F_SEAL_GROW | fcntl.F_SEAL_SEAL)
            return cls(mmap.mmap(file, capacity)), file
        except BaseException:
            os.close(file)
            raise

    @classmethod
    def map(cls, file: int) -> "Frame":
        """Maps the frame of a descriptor, and closes that."""
        try:
            return cls(mmap.mmap(file, os.fstat(file).st_size))
        finally:
            os.close(file)

    @property
    def capacity(self) -> int:
        """Bytes that it holds."""
        return len(self.memory)

    def read(self, size: int) -> bytes:
        """Copies the first `size` bytes."""
        return self.memory[:size]

    def write(self, data: bytes) -> None:
        """Puts data at the start."""
        self.memory[: len(data)] = data

    def array(self, dtype: "np.dtype[Any] | str", shape: tuple[int, ...]) -> NDArray[Any]:
        """Returns an array at the start, which is this memory."""
        return np.ndarray(shape, dtype, buffer=self.memory)


def receive(link: socket.socket) -> tuple[bytes, int | None]:
    """Waits for a packet, on the side that trusts the other one.

    Returns:
        The packet, empty where the other side has ended; and a descriptor that came with it.
    """
    packet, files, _, _ = socket.recv_fds(link, PACKET, 1)
    return packet, files[0] if files else None
