"""A process in which one agent of a submission plays, from our side, which trusts nothing that it sends."""

import os
import socket
from contextlib import suppress
from typing import Any, NoReturn

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.isolation import frames
from overcooked_bench.agents.isolation.frames import Frame, Message
from overcooked_bench.agents.isolation.sandbox import Sandbox
from overcooked_bench.agents.submissions.checks import ForeignFault
from overcooked_bench.agents.watch import NO_ANSWER


class Remote:
    """A process of a submission.

    Args:
        sandbox: Where it runs.

    Raises:
        ForeignFault: It cannot be started any more.
    """

    def __init__(self, sandbox: Sandbox) -> None:
        self._sandbox = sandbox
        self._process, self._link = sandbox.copy()
        self._frame: Frame | None = None
        self._number = 0
        self._fault: str | None = None

    def ask(
        self, request: Message, content: "bytes | NDArray[Any]", most: int, what: str, allowance: float = 1.0
    ) -> tuple[Message, bytes]:
        """Sends a request and waits for the answer.

        Args:
            request: The request; its number and size are filled in.
            content: Its content.
            most: Bytes that the content of a good answer may have.
            what: What is called, for messages.
            allowance: How many times the usual limit it may take.

        Returns:
            The answer and its content, both as the submission chose them.

        Raises:
            ForeignFault: It did not answer in time, ended, or sent something else; the process is ended.
        """
        if self._fault is not None:
            raise ForeignFault(self._fault)
        size = content.nbytes if isinstance(content, np.ndarray) else len(content)
        if size > frames.MOST:
            self._fail(f"{what}: its observations have {size:,} bytes; {frames.MOST:,} can be sent at once")
        output = self._sandbox.output
        if self._peek():
            self._fail(f"{what}: it sent a message that it was not asked for")
        self._number += 1
        request = request._replace(number=self._number, size=size)
        frame = self._send(request, content, max(size, most))
        limit = self._sandbox.isolation.act_timeout * allowance
        if not output.wait(self._link, limit):
            self._fail(f"{what}: {NO_ANSWER} {limit:g} s; --act-timeout gives a slow agent longer")
        return self._take(frame, most, what)

    def close(self) -> None:
        """Ends the process."""
        if self._fault is None:
            self._fault = "its process was ended"
            self._sandbox.end(self._process)
            self._link.close()

    def _send(self, request: Message, content: "bytes | NDArray[Any]", size: int) -> Frame:
        """Writes the content and sends the request, with a larger frame where one is needed."""
        frame, file = self._frame, -1
        if frame is None or frame.capacity < size:
            frame, file = Frame.make(size)
            self._frame = frame
        if isinstance(content, np.ndarray):
            frame.array(content.dtype, content.shape)[...] = content
        else:
            frame.write(content)
        with suppress(OSError):  # one that has ended is noticed when its answer is read
            if file < 0:
                self._link.send(request.pack(), socket.MSG_DONTWAIT)
            else:
                socket.send_fds(self._link, [request.pack()], [file], socket.MSG_DONTWAIT)
        if file >= 0:
            os.close(file)
        return frame

    def _take(self, frame: Frame, most: int, what: str) -> tuple[Message, bytes]:
        """Reads an answer and its content."""
        packet = b""
        with suppress(OSError):
            packet = self._link.recv(frames.PACKET + 1, socket.MSG_DONTWAIT)
        if not packet:
            self._fail(f"{what}: {self._sandbox.how_ended(self._process)}")
        try:
            answer = Message.unpack(packet)
        except ValueError:
            self._fail(f"{what}: it sent a message that is no answer")
        if answer.kind not in frames.ANSWERS:
            self._fail(f"{what}: it sent a message that is no answer")
        if answer.number != self._number:
            self._fail(f"{what}: it sent an answer to another request")
        if answer.size > (most if answer.kind == frames.DONE else frames.LONGEST_TEXT):
            self._fail(f"{what}: it sent an answer of {answer.size:,} bytes")
        return answer, frame.read(answer.size)

    def _peek(self) -> bool:
        """Returns whether there is a message, and not the end of the connection."""
        with suppress(OSError):
            return bool(self._link.recv(1, socket.MSG_DONTWAIT | socket.MSG_PEEK))
        return False

    def _fail(self, what: str) -> NoReturn:
        """Ends the process.

        Raises:
            ForeignFault: Always.
        """
        self._sandbox.output.drain()
        self.close()
        self._fault = what
        raise ForeignFault(what)
