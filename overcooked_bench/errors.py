"""The errors of this package, in one tree.

    OvercookedBenchError
    ├── WrongUse      the user gave something that cannot be used (exit code 2)
    │   ├── LayoutError, ProtocolError, PoolError, PolicyError, StoreError, ScoresError, ...
    │   └── UnknownLayout: an agent declines a layout
    ├── AgentFault    an agent broke the contract while it played (exit code 1)
    └── Difference    a recorded game does not replay as it was recorded (exit code 1)

Every message says what was given, what was expected and what to write instead, so a command prints it without a
traceback. Any other exception is a bug of ours.
"""


class OvercookedBenchError(Exception):
    """Any error that this package raises on purpose.

    Attributes:
        exit_code: What the command line exits with.
    """

    exit_code = 2


class WrongUse(OvercookedBenchError, ValueError):
    """Something that the user gave cannot be used; the message says what to write instead."""


class AgentFault(OvercookedBenchError, RuntimeError):
    """An agent broke the contract while it played."""

    exit_code = 1
