"""`Visit`: one open page, from its consent to its last game; takes messages and says dictionaries, without sockets."""

import asyncio
import secrets
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from overcooked_bench.errors import AgentFault, OvercookedBenchError
from overcooked_bench.human.server.house import House
from overcooked_bench.human.server.keeping import new_label
from overcooked_bench.human.server.messages import Begin, Join, Leave, Message, MessageError, Watch
from overcooked_bench.human.server.participant import Participant
from overcooked_bench.human.server.playing import Page, Playing
from overcooked_bench.human.study.log import StudyLog


@dataclass
class Hall:
    """Where people come in.

    Attributes:
        house: What is played here.
        log: Of the study that this server is for, if it is for one.
        visits: All open pages.
        waiting: Room -> the visit whose person waits there for another one.
    """

    house: House
    log: StudyLog | None = None
    visits: set[Page] = field(default_factory=set)
    waiting: "dict[str, Visit]" = field(default_factory=dict)

    def enter(self, say: Callable[[dict[str, Any]], object]) -> Page:
        """Lets a page in.

        Args:
            say: Sends a message to the page; never waits.
        """
        visit: Page = Visit(self, say) if self.log is None else Participant(self.house, self.log, say)
        self.visits.add(visit)
        return visit


class Visit(Page):
    """A page on which games are chosen.

    Args:
        hall: Where it is.
        say: Sends a message to the page; never waits.
    """

    def __init__(self, hall: Hall, say: Callable[[dict[str, Any]], object]) -> None:
        super().__init__(say, new_label())
        self._hall, self._house, self._room = hall, hall.house, ""

    async def follow(self, message: Message) -> None:
        """Begins, joins, watches or leaves a game.

        Raises:
            MessageError: It does not fit what is going on.
        """
        match message:
            case Begin():
                await self._begin(message)
            case Watch(layout=layout, agents=agents):
                self._free()
                await self._start(layout, [agents[0], agents[1]], [self])
            case Join(room=room):
                await self._join(room)
            case Leave():
                if self.playing is not None or self._room:
                    self.leave()
                    self.say({"type": "left"})
            case _:
                raise MessageError("this server is for no study; begin a game")

    def leave(self) -> None:
        """Ends what is going on; for a page that was closed, too."""
        self._hall.waiting.pop(self._room, None)
        self._room = ""
        if self.playing is not None:
            self.playing.stop(self)

    async def _begin(self, wanted: Begin) -> None:
        self._free()
        if wanted.partner is not None:
            cast: list[str | None] = [wanted.partner, wanted.partner]
            cast[wanted.seat] = None
            await self._start(wanted.layout, cast, [self])
            return
        self._check(wanted.layout)
        self._room = secrets.token_hex(4)
        self._wanted = wanted
        self._hall.waiting[self._room] = self
        self.say({"type": "waiting", "room": self._room, "layout": wanted.layout})

    async def _join(self, room: str) -> None:
        self._free()
        host = self._hall.waiting.pop(room, None)
        if host is None:
            raise MessageError("nobody waits there (any more); ask for a new link")
        wanted, host._room = host._wanted, ""
        visits = [host, self] if wanted.seat == 0 else [self, host]
        await self._start(wanted.layout, [None, None], visits)

    def _free(self) -> None:
        if self.playing is not None or self._room:
            raise MessageError("a game is going on; leave it first")

    def _check(self, layout: str, *agents: str) -> None:
        if layout not in self._house.terms.layouts:
            raise MessageError(f"no layout {layout!r} here; there are {', '.join(self._house.terms.layouts)}")
        offers = self._house.cast.offers(layout)
        for agent in agents:
            if not offers.has(agent):
                raise MessageError(f"{agent!r} is not offered on {layout}{_why(offers.refused.get(agent))}")

    async def _start(self, layout: str, cast: list[str | None], visits: "list[Visit]") -> None:
        """Starts a game; `cast` has None for each seat of a person."""
        self._check(layout, *(agent for agent in cast if agent is not None))
        playing = Playing(self._house, visits, [visit for visit in visits if None in cast])
        for visit in visits:
            visit.playing = playing
        try:
            game = await asyncio.to_thread(self._house.game, layout, cast)
        except (OvercookedBenchError, AgentFault) as error:
            playing.fail(str(error))
            return
        playing.start(game)


def _why(reason: str | None) -> str:
    return f": {reason}" if reason else "; choose one from the list"
