"""`Isolation`: how submissions are kept apart, and what each of their processes may use."""

import platform
import sys
from dataclasses import dataclass
from typing import Final, Literal

from overcooked_bench.agents.isolation import HOWS
from overcooked_bench.agents.isolation.bubblewrap import missing
from overcooked_bench.agents.isolation.seccomp import MACHINES
from overcooked_bench.errors import WrongUse

Level = Literal["strong", "weak"]
How = Literal["best", "strict"]

_MIB: Final = 1 << 20


class IsolationError(WrongUse):
    """Submissions cannot be isolated here as they should be; the message says what to install."""


@dataclass(frozen=True)
class Limits:
    """What one process of a submission may use.

    Attributes:
        memory: Bytes of memory that it allocates.
        address_space: Bytes that it maps, libraries and shared memory included.
        cpu_seconds: Seconds of CPU time.
        file_bytes: Greatest file that it writes; with bubblewrap also the size of its folder for temporary files.
        open_files: Files that are open at once.
    """

    memory: int = 4096 * _MIB
    address_space: int = 16384 * _MIB
    cpu_seconds: int = 4 * 3600
    file_bytes: int = 256 * _MIB
    open_files: int = 256


@dataclass(frozen=True)
class Isolation:
    """How submissions are isolated in a run; small enough to be sent anywhere.

    Attributes:
        level: "strong" in a sandbox of bubblewrap; "weak" with the limits of the operating system alone.
        why: Why it is weak, else an empty text.
        act_timeout: Seconds that one call of `act` may take; loading may take ten times as long.
        limits: What each process may use.
    """

    level: Level
    why: str
    act_timeout: float
    limits: Limits = Limits()

    @property
    def short(self) -> str:
        """The level, and why it is weak."""
        return f"{self.level} ({self.why})" if self.why else self.level

    @property
    def sentence(self) -> str:
        """Says how good the isolation is, for results."""
        if self.level == "strong":
            return "The submission played in a sandbox of its own (bubblewrap)."
        return (
            f"Isolation was weak ({self.why}): the submission played in a process of its own with limits of the "
            "operating system, and could read and write files with the user's permissions."
        )


def isolate(how: How, act_timeout: float) -> Isolation:
    """Returns the best isolation that this machine offers.

    Args:
        how: "best" makes do with weak isolation; "strict" does not.
        act_timeout: Seconds that one call of a submission's `act` may take.

    Raises:
        IsolationError: Submissions cannot be isolated on this system at all, or only weakly and `how` is "strict".
    """
    if how not in HOWS:
        raise IsolationError(f"isolate={how!r}; write one of {', '.join(HOWS)}")
    if sys.platform != "linux":
        raise IsolationError(f"isolation needs Linux, and this is {sys.platform}; use a container or virtual machine")
    machine = platform.machine()
    why = missing() if machine in MACHINES else f"there is no filter of system calls for {machine} processors"
    if why and how == "strict":
        raise IsolationError(
            f"strict isolation is not possible here: {why}. On Debian and Ubuntu: apt-get install bubblewrap (version "
            "0.8 or newer), and allow user namespaces; --isolate=best makes do with less and says so in the result"
        )
    return Isolation("weak" if why else "strong", why, act_timeout)
