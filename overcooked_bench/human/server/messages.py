"""What a page may send, and nothing else: one JSON object per message, distinguished by the key `type`."""

from typing import Annotated, Final, Literal

import msgspec
from msgspec import Meta

from overcooked_bench.errors import WrongUse
from overcooked_bench.human.study.log import Code

MOST_BYTES: Final = 2048
"""Of one message; the server closes the connection at a longer one."""

Seat = Annotated[int, Meta(ge=0, le=1)]
Action = Annotated[int, Meta(ge=0, le=5)]
Name = Annotated[str, Meta(min_length=1, max_length=300)]


class MessageError(WrongUse):
    """A page sent something that is no message, or not now; the message says what was expected."""


class Consent(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="consent"):
    """Answers whether games may be kept.

    Attributes:
        agree: Whether they may.
    """

    agree: bool


class Begin(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="begin"):
    """Asks for a game with an agent, or with another person.

    Attributes:
        layout: Where.
        partner: A reference that was offered, or None to wait for another person.
        seat: The person's.
    """

    layout: Name
    seat: Seat
    partner: Name | None = None


class Join(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="join"):
    """Takes the free seat in the kitchen of a person who waits.

    Attributes:
        room: What that person's page shows.
    """

    room: Annotated[str, Meta(pattern=r"^[a-z0-9]{8}\Z")]


class Watch(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="watch"):
    """Asks for a game of two agents.

    Attributes:
        layout: Where.
        agents: References that were offered, for seats 0 and 1.
    """

    layout: Name
    agents: tuple[Name, Name]


class Press(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="press"):
    """Says that a key went down.

    Attributes:
        action: What it stands for.
    """

    action: Action


class Release(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="release"):
    """Says that a key went up.

    Attributes:
        action: What it stands for.
    """

    action: Action


class Control(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="control"):
    """Changes how a watched game goes on.

    Attributes:
        do: "pause", "resume", or "step" for one step of a paused game.
    """

    do: Literal["pause", "resume", "step"]


class Take(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="take"):
    """Takes over a chef of a watched game, or gives it back.

    Attributes:
        seat: Whose keys the person's are from now on; None gives the chef back to its agent.
    """

    seat: Seat | None


class Leave(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="leave"):
    """Ends the game."""


class Enroll(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="enroll"):
    """Takes part in the study that this server is for.

    Attributes:
        code: What the page drew, or kept from before.
    """

    code: Code


class Next(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="next"):
    """Asks for the next game of a study."""


class Answers(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="answers"):
    """Answers the questions about the last game of a study.

    Attributes:
        answers: Question -> number on its scale.
    """

    answers: Annotated[dict[Annotated[str, Meta(max_length=60)], int], Meta(max_length=10)]


class Ping(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="ping"):
    """Asks for an answer at once, to measure the time on the way.

    Attributes:
        at: The page's clock, in milliseconds; comes back as it is.
    """

    at: float


Message = Consent | Begin | Join | Watch | Press | Release | Control | Take | Leave | Enroll | Next | Answers | Ping

_DECODER: Final = msgspec.json.Decoder(Message)


def parse(text: str) -> Message:
    """Reads a message.

    Raises:
        MessageError: It is none; says why.
    """
    try:
        message: Message = _DECODER.decode(text)
    except (msgspec.MsgspecError, UnicodeError, RecursionError) as error:
        raise MessageError(f"not a message: {error}") from None
    return message
