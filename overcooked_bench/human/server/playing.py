"""`Playing`: one game, and the pages that it is shown on."""

import asyncio
from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from typing import Any, Final

from overcooked_bench.errors import AgentFault, OvercookedBenchError
from overcooked_bench.human.server.chefs import AgentChef, Chef, Person, Taken
from overcooked_bench.human.server.house import House
from overcooked_bench.human.server.live import LiveGame
from overcooked_bench.human.server.messages import (
    Consent,
    Control,
    Message,
    MessageError,
    Ping,
    Press,
    Release,
    Take,
)
from overcooked_bench.human.server.pace import Pace

TROUBLE: Final = "the game cannot be played; please report it to the people who do this study"
"""What a blinded page says if an agent is at fault."""


class Page(ABC):
    """An open page, whatever it is for.

    Args:
        say: Sends a message to it; never waits.
        label: Of its person's visit.

    Attributes:
        say: As given.
        label: As given, or set later.
        agreed: Whether its person agreed that games are kept; None until then.
        playing: The game that is shown on it.
    """

    def __init__(self, say: Callable[[dict[str, Any]], object], label: str = "") -> None:
        self.say, self.label = say, label
        self.agreed: bool | None = None
        self.playing: Playing | None = None

    async def hear(self, message: Message) -> None:
        """Does what a message asks for.

        Raises:
            MessageError: It does not fit what is going on.
        """
        match message:
            case Ping(at=at):
                self.say({"type": "pong", "at": at})
            case Consent(agree=agree):
                self.agreed = agree
            case Press() | Release() | Control() | Take():
                if self.playing is None:
                    raise MessageError("no game is going on; begin one")
                self.playing.hear(self, message)
            case _ if self.agreed is None:
                raise MessageError("no answer yet to whether games may be kept; send consent first")
            case _:
                await self.follow(message)

    @abstractmethod
    async def follow(self, message: Message) -> None:
        """Does what a message other than keys, consent and pings asks for.

        Raises:
            MessageError: It does not fit what is going on.
        """

    @abstractmethod
    def leave(self) -> None:
        """Ends what is going on, since the page was closed."""


class Playing:
    """A game and the pages that it is shown on.

    Args:
        house: What they share.
        visits: One page, or those of the two people on seats 0 and 1.
        people: Those of them who are in the game.
        blind: What a page shows instead of the agents' names; None shows them.
        notes: Goes into the record of the game.
        on_end: Is called when the game was played to its end and, if it is kept, written.

    Attributes:
        game: The game; None while its agents are loaded.
    """

    def __init__(
        self,
        house: House,
        visits: Sequence[Page],
        people: Sequence[Page],
        blind: str | None = None,
        notes: str = "",
        on_end: Callable[[LiveGame], object] = lambda game: None,
    ) -> None:
        self._house, self._visits, self._people = house, list(visits), list(people)
        self._blind, self._notes, self._on_end = blind, notes, on_end
        self.game: LiveGame | None = None
        self._agents: list[Chef] = []
        self._pace = Pace(house.terms.pace, self._step)
        self._task: asyncio.Task[None] | None = None

    def start(self, game: LiveGame) -> None:
        """Shows the kitchen, and plays it."""
        if not self._visits:  # all have left while the agents were loaded
            return
        self.game, self._agents = game, list(game.chefs)
        for visit in self._visits:
            visit.say(self._kitchen(game, self._seat(visit)))
        game.look()
        self._task = asyncio.get_running_loop().create_task(self._run())

    def hear(self, visit: Page, message: Message) -> None:
        """Does what a page of this game asks for.

        Raises:
            MessageError: It does not fit this game.
        """
        game = self.game
        if game is None:
            raise MessageError("the game has not started yet")
        if isinstance(message, Press | Release):
            if (person := self._person(visit)) is not None:
                (person.press if isinstance(message, Press) else person.release)(message.action)
        elif self._people:
            raise MessageError("a game in which people play is not paused; leave it, or watch one")
        elif isinstance(message, Take):
            game.chefs = [Taken(chef) if index == message.seat else chef for index, chef in enumerate(self._agents)]
        elif isinstance(message, Control):
            self._control(message.do)

    def stop(self, visit: Page) -> None:
        """Ends the game for a page that leaves, and so for the other one."""
        self._visits = [other for other in self._visits if other is not visit]
        visit.playing = None
        if self._task is not None:
            self._task.cancel()
        for other in self._visits:
            other.playing = None
            other.say({"type": "error", "text": "the other person has left; the game is not kept"})
            other.say({"type": "left"})
        self._visits = []

    def fail(self, text: str) -> None:
        """Ends the game since it cannot be played."""
        for visit in self._visits:
            visit.playing = None
            visit.say({"type": "error", "text": text})
            visit.say({"type": "left"})
        self._visits = []

    def _control(self, do: str) -> None:
        if do == "pause":
            self._pace.pause()
        elif do == "resume":
            self._pace.resume()
        elif not self._pace.paused:
            raise MessageError("single steps need a paused game; pause it first")
        elif not self._step():
            self._pace.resume()  # to its end

    def _seat(self, visit: Page) -> int | None:
        """The seat of a page's person, None for one who watches."""
        if visit not in self._people:
            return None
        assert self.game is not None
        own = [seat for seat in (0, 1) if self.game.person(seat) is not None]
        return own[0] if len(own) == 1 else self._visits.index(visit)

    def _person(self, visit: Page) -> Person | None:
        """Whose keys those of a page are."""
        assert self.game is not None
        seat = self._seat(visit) if self._people else next((s for s in (0, 1) if self.game.person(s)), None)
        return None if seat is None else self.game.person(seat)

    def _is_kept(self) -> bool:
        return self._house.kept is not None and bool(self._people) and all(visit.agreed for visit in self._people)

    def _step(self) -> bool:
        """Plays a step and shows it; returns whether there is another one."""
        game = self.game
        assert game is not None
        if not game.left:
            return False
        try:
            game.step()
        except AgentFault as error:
            self.fail(f"{error}; the game is not kept" if self._blind is None else TROUBLE)
            return False
        frame = {"type": "frame", "frame": game.frame(), "late": game.late}
        for visit in self._visits:
            visit.say(frame)
        if game.left:
            game.look()
        return bool(game.left)

    async def _run(self) -> None:
        game, house = self.game, self._house
        assert game is not None
        await self._pace.run(house.terms.countdown)
        visits, self._visits = self._visits, []
        if game.left:
            return
        for visit in visits:
            visit.playing = None
        end = {"type": "end", "points": game.points, "soups": game.soups, "steps": len(game.actions), "kept": False}
        if self._is_kept():
            try:
                end["kept"] = await house.keep(game, [visit.label for visit in self._people], self._notes)
                self._on_end(game)
            except (OvercookedBenchError, OSError) as error:
                end["error"] = str(error)
        for visit in visits:
            visit.say(end)

    def _kitchen(self, game: LiveGame, seat: int | None) -> dict[str, Any]:
        """What a page is sent when its game begins; `seat` is that of its person."""
        terms = self._house.terms
        people = ["you" if seat == index else "the other person" for index in (0, 1)]
        named = [
            (self._blind or chef.entrant.name) if isinstance(chef, AgentChef) else people[index]
            for index, chef in enumerate(game.chefs)
        ]
        return {
            "type": "kitchen",
            "layout": game.layout.name,
            "grid": list(game.layout.rows),
            "names": named,
            "seat": seat,
            "horizon": game.horizon,
            "pace": round(1000 * terms.pace),
            "countdown": terms.countdown,
            "kept": self._is_kept(),
            "frame": game.frame(),
        }
