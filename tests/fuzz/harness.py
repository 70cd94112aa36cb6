"""Mutated files against a reader: whatever is in a file, the reader answers, or raises the errors that it declares."""

import random
import resource
import signal
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest

TRIES = pytest.mark.parametrize(
    "tries", [pytest.param(200, id="few"), pytest.param(5000, id="many", marks=pytest.mark.fuzz)]
)
"""How often a format is tried: a few times in every run, 5,000 times with `-m fuzz`."""

LIMIT = 5.0
"""Seconds of computing after which a try counts as a hang; it may wait ten times as long."""

MEMORY = 3 << 30
"""Bytes that a try may ask for beyond what the process has."""


class Hang(BaseException):
    """A try did not end."""


@dataclass
class Tally:
    """What came of many tries.

    Attributes:
        format: What was read.
        accepted: How many files were read.
        refused: How many were refused with a declared error.
        foreign: Any other exception -> how often.
        hangs: Tries that were ended by `LIMIT`.
        slowest: Seconds of the longest try.
        examples: Any other exception -> the first file that caused it.
    """

    format: str
    accepted: int = 0
    refused: int = 0
    foreign: Counter[str] = field(default_factory=Counter)
    hangs: int = 0
    slowest: float = 0.0
    examples: dict[str, bytes] = field(default_factory=dict)

    def __str__(self) -> str:
        tries = self.accepted + self.refused + self.foreign.total() + self.hangs
        return (
            f"{self.format}: {tries} tries, {self.accepted} read, {self.refused} refused, "
            f"{self.foreign.total()} foreign exceptions, {self.hangs} hangs, slowest {self.slowest:.2f} s"
        )

    def check(self, refuses: bool = True) -> None:
        """Fails if anything else happened than that files were read or refused.

        Args:
            refuses: Whether some files have to be refused.
        """
        print(self)
        told = [f"{times} x {name}: {self.examples[name][:400]!r}" for name, times in self.foreign.most_common()]
        assert (self.foreign.total(), self.hangs) == (0, 0), "\n".join([str(self), *told])
        assert bool(self.refused) == refuses, str(self)


def attack(
    name: str,
    whole: Iterable[bytes],
    inputs: Iterator[bytes],
    read: Callable[[bytes], object],
    declared: type[Exception] | tuple[type[Exception], ...],
    tries: int,
    limit: float = LIMIT,
) -> Tally:
    """Reads mutated files.

    Args:
        name: The format's, for the report.
        whole: Files that are as they should be; each is read first.
        inputs: Changed ones, without end.
        read: Reads one.
        declared: The errors that it may raise.
        tries: How many files.
        limit: Seconds of computing for each, and ten times as many of waiting.
    """
    tally = Tally(name)
    for content in whole:
        read(content)
    with _bounded():
        for _ in range(tries):
            content = next(inputs)
            began = time.perf_counter()
            try:
                with _alarm(limit):
                    read(content)
                tally.accepted += 1
            except declared:
                tally.refused += 1
            except Hang:
                tally.hangs += 1
                tally.examples["Hang"] = content
            except BaseException as error:
                if isinstance(error, KeyboardInterrupt | SystemExit):
                    raise
                what = f"{type(error).__name__}: {str(error)[:200]} at {_where(error)}"
                tally.foreign[what] += 1
                tally.examples.setdefault(what, content)
            tally.slowest = max(tally.slowest, time.perf_counter() - began)
    return tally


def _where(error: BaseException) -> str:
    trace, place = error.__traceback__, ""
    while trace:
        file = Path(trace.tb_frame.f_code.co_filename)
        if {"overcooked_bench", "baselines"} & set(file.parts) and "site-packages" not in file.parts:
            place = f"{file.name}:{trace.tb_lineno}"
        trace = trace.tb_next
    return place


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    """Ends what computes for so long, or waits for ten times as long: a busy machine is no hang."""

    def ring(*_: object) -> None:
        raise Hang

    clocks = {signal.SIGPROF: (signal.ITIMER_PROF, seconds), signal.SIGALRM: (signal.ITIMER_REAL, 10 * seconds)}
    before = {number: signal.signal(number, ring) for number in clocks}
    for clock, length in clocks.values():
        signal.setitimer(clock, length)
    try:
        yield
    finally:
        for number, (clock, _) in clocks.items():
            signal.setitimer(clock, 0)
            signal.signal(number, before[number])


@contextmanager
def _bounded() -> Iterator[None]:
    """Makes a file that asks for too much memory a MemoryError in place of a machine without any."""
    if not sys.platform.startswith("linux"):
        yield
        return
    soft, hard = resource.getrlimit(resource.RLIMIT_AS)
    pages = int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (pages * resource.getpagesize() + MEMORY, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_AS, (soft, hard))


def seeded(name: str) -> random.Random:
    """Makes the source of a format's mutations."""
    return random.Random(f"fuzz {name}")


def mixed(rng: random.Random, *sources: Iterator[bytes]) -> Iterator[bytes]:
    """Draws from several sources of files, each as often."""
    while True:
        yield next(rng.choice(sources))
