"""What a submission's process does: it loads the submission, and answers requests with actions or texts."""

import socket
from typing import Any

import msgspec
import numpy as np

from overcooked_bench.agents.agent import Agent, GameError, UnknownLayout
from overcooked_bench.agents.isolation import frames
from overcooked_bench.agents.isolation.frames import Frame, Message
from overcooked_bench.agents.saying import describe, say
from overcooked_bench.agents.seeding import seed_generators
from overcooked_bench.agents.submissions.checks import ActionError, AgentError, check_actions
from overcooked_bench.agents.submissions.loading import Submission, load_submission
from overcooked_bench.kitchen.state import KitchenState


class Wanted(msgspec.Struct, frozen=True):
    """The agent that a request asks for.

    Attributes:
        layout: The layout's name, or a grid's text.
        training_seed: Which training run.
        key: Seeds the global generators; None leaves them alone.
    """

    layout: str
    training_seed: int
    key: int | None


class Made(msgspec.Struct, frozen=True):
    """The agent that was made.

    Attributes:
        observation: What it observes.
    """

    observation: str


class Facts(msgspec.Struct, frozen=True):
    """What a submission says about itself.

    Attributes:
        training_seeds: The number of its training runs.
        codebase: `Origin.codebase`.
        people: `Origin.people`; None if it says nothing about its origin.
    """

    training_seeds: int
    codebase: str | None = None
    people: tuple[str, ...] | None = None


def serve(link: socket.socket, path: str, function: str) -> None:
    """Answers requests until the other side ends."""
    player = _Player(path, function)
    frame: Frame | None = None
    while True:
        packet, file = frames.receive(link)
        if not packet:
            return
        frame = frame if file is None else Frame.map(file)
        assert frame is not None
        request = Message.unpack(packet)
        kind, content, row = _answer(player, request, frame)
        if kind != frames.DONE:
            content = content[: frames.LONGEST_TEXT]
        frame.write(content)
        link.send(Message(kind, request.number, len(content), row).pack())


def _answer(player: "_Player", request: Message, frame: Frame) -> tuple[int, bytes, int]:
    """Carries a request out; whatever the submission raises becomes a text."""
    try:
        return frames.DONE, player.do(request, frame), -1
    except UnknownLayout as error:
        return frames.DECLINED, say(error).encode("utf-8", "replace"), -1
    except ActionError as error:
        return frames.NO_ACTION, str(error).encode("utf-8", "replace"), -1 if error.row is None else error.row
    except GameError as error:
        return frames.GAME, say(error).encode("utf-8", "replace"), error.row if type(error) is GameError else -1
    except AgentError as error:
        kind = frames.AT_FAULT if request.kind in (frames.FACTS, frames.MAKE) else frames.RAISED
        text = str(error) if kind == frames.AT_FAULT else describe(error)
        return kind, text.encode("utf-8", "replace"), -1
    except BaseException as error:
        return frames.RAISED, describe(error).encode("utf-8", "replace"), -1


class _Player:
    """The submission and its agent.

    Args:
        path: The submission.
        function: The function in it that makes agents.
    """

    def __init__(self, path: str, function: str) -> None:
        self._path, self._function = path, function
        self._agent: Agent | None = None

    def do(self, request: Message, frame: Frame) -> bytes:
        """Returns the content of the answer."""
        if request.kind == frames.FACTS:
            return msgspec.json.encode(_facts(load_submission(self._path, self._function)))
        if request.kind == frames.MAKE:
            return msgspec.json.encode(self._make(msgspec.json.decode(frame.read(request.size), type=Wanted)))
        assert self._agent is not None
        if request.kind == frames.RESET:
            batch, length = request.shape
            numbers = np.frombuffer(frame.read(request.size), np.uint8)
            seats, seeds = numbers[: 8 * batch].view(np.int64), numbers[8 * batch : 16 * batch].view(np.uint64)
            self._agent.reset(numbers[-length:].tobytes().decode() if length else "", seats.copy(), seeds.copy())
            return b""
        seen: Any
        if request.kind == frames.STATES:
            seen = [KitchenState.from_dict(state) for state in msgspec.json.decode(frame.read(request.size))]
            batch = len(seen)
        else:
            seen = frame.array(request.dtype, request.shape).copy()
            batch = request.shape[0]
        return check_actions(self._agent.act(seen), batch).astype(np.uint8).tobytes()

    def _make(self, wanted: Wanted) -> Made:
        submission = load_submission(self._path, self._function)
        if wanted.key is not None:
            seed_generators(wanted.key)
        self._agent = submission.make_agent(wanted.layout, wanted.training_seed)
        return Made(self._agent.observation)


def _facts(submission: Submission) -> Facts:
    origin = submission.origin
    if origin is None:
        return Facts(submission.training_seeds)
    return Facts(submission.training_seeds, origin.codebase, origin.people)
