"""Steps at a fixed pace."""

import asyncio
from collections.abc import Callable


class Pace:
    """Calls a function at fixed times: k seconds after the k-th, whatever the calls before took.

    Args:
        seconds: Between two calls.
        step: What is called; returns whether there is to be another call.
    """

    def __init__(self, seconds: float, step: Callable[[], bool]) -> None:
        self._seconds, self._step = seconds, step
        self._going = asyncio.Event()
        self._going.set()

    @property
    def paused(self) -> bool:
        """Whether it waits to be resumed."""
        return not self._going.is_set()

    def pause(self) -> None:
        """Makes no call from now on."""
        self._going.clear()

    def resume(self) -> None:
        """Goes on, with the next call after a whole interval."""
        self._going.set()

    async def run(self, wait: float = 0.0) -> None:
        """Makes all calls.

        A call that comes more than an interval late, after the machine was asleep, does not make the others hurry.

        Args:
            wait: Seconds before the first interval begins.
        """
        loop = asyncio.get_running_loop()
        due = loop.time() + wait + self._seconds
        while True:
            if self.paused:
                await self._going.wait()
                due = loop.time() + self._seconds
            await asyncio.sleep(due - loop.time())
            if self.paused:
                continue
            if not self._step():
                return
            due = max(due, loop.time() - self._seconds) + self._seconds
