"""`Participant`: the page of somebody who takes part in a study; is never sent a partner's name or condition."""

import asyncio
from collections.abc import Callable
from typing import Any

import msgspec

from overcooked_bench.errors import AgentFault, OvercookedBenchError
from overcooked_bench.human.server.chefs import AgentChef
from overcooked_bench.human.server.house import House
from overcooked_bench.human.server.live import LiveGame
from overcooked_bench.human.server.messages import Answers, Enroll, Leave, Message, MessageError, Next
from overcooked_bench.human.server.playing import TROUBLE, Page, Playing
from overcooked_bench.human.study.log import Played, StudyLog
from overcooked_bench.human.study.plan import StudyError, Trial


class Participant(Page):
    """The page of a participant.

    Args:
        house: What is played here.
        log: The study's record.
        say: Sends a message to the page; never waits.
    """

    def __init__(self, house: House, log: StudyLog, say: Callable[[dict[str, Any]], object]) -> None:
        super().__init__(say)
        self._house, self._log = house, log

    async def follow(self, message: Message) -> None:
        """Goes on with the study.

        Raises:
            MessageError: It does not fit what is going on.
        """
        match message:
            case _ if not self.agreed:
                raise MessageError("only those who agree take part; send consent first")
            case Enroll(code=code):
                self._enroll(code)
            case _ if not self.label:
                raise MessageError("no participant yet; enroll first")
            case Next():
                await self._next()
            case Answers(answers=answers):
                self._answer(answers)
            case Leave():
                self._stop()
            case _:
                raise MessageError("the study says what is played; ask for the next game")

    def leave(self) -> None:
        """Ends what is going on, since the page was closed; the game is played again when it is opened."""
        self._stop()
        if self.label:
            self._log.leave(self.label)

    def _stop(self) -> None:
        if self.playing is not None:
            self.playing.stop(self)
            self._show()

    def _enroll(self, code: str) -> None:
        if self.label or self._log.is_present(code):
            raise MessageError("this study is open in another tab; go on there")
        self._log.enter(code)
        self.label = code
        self._show()

    def _show(self) -> None:
        """Says what comes next: questions, a game, or thanks."""
        trial, plan = self._log.next_trial(self.label), self._log.study.plan
        if (game := self._log.unanswered(self.label)) is not None:
            questions = msgspec.to_builtins(plan.questions)
            trials = self._log.study.trials(self._log.participants[self.label].number)
            self.say({"type": "questions", "partner": trials[game].label, "questions": questions})
        elif trial is None:
            self.say({"type": "thanks", "code": self.label})
        else:
            number = self._log.participants[self.label].number
            of = len(self._log.study.trials(number))
            self.say({"type": "trial", "number": trial.number + 1, "of": of, "partner": trial.label})

    async def _next(self) -> None:
        trial = self._log.next_trial(self.label)
        if self.playing is not None or trial is None or self._log.unanswered(self.label) is not None:
            raise MessageError("not now; answer the questions, or play the game that is going on")
        study = self._log.study.plan.name
        notes = f"study {study}, game {trial.number}, condition {trial.condition}"
        playing = Playing(self._house, [self], [self], trial.label, notes, lambda game: self._played(game, trial))
        self.playing = playing
        cast: list[str | None] = [trial.partner, trial.partner]
        cast[trial.seat] = None
        try:
            game = await asyncio.to_thread(self._house.game, trial.layout, cast)
        except (OvercookedBenchError, AgentFault):
            playing.fail(TROUBLE)
            return
        playing.start(game)

    def _played(self, game: LiveGame, trial: Trial) -> None:
        (partner,) = (chef.entrant.sha256 for chef in game.chefs if isinstance(chef, AgentChef))
        steps = len(game.actions)
        self._log.played(Played(self.label, trial.number, game.points, game.soups, steps, game.late, partner))
        self._show()

    def _answer(self, answers: dict[str, int]) -> None:
        try:
            self._log.answered(self.label, answers)
        except StudyError as error:
            raise MessageError(str(error)) from None
        self._show()
