"""What has happened in a study: a file of one JSON object per line, which is only ever added to."""

from collections.abc import Iterator
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Annotated, Final, cast

import msgspec
from msgspec import Meta

from overcooked_bench.documents import parse_json
from overcooked_bench.files import append_line, cut_unfinished_line, read_regular, shown
from overcooked_bench.human.study.plan import Study, StudyError, Trial

FILE: Final = "study.jsonl"
MOST_BYTES: Final = 1 << 26
CODE: Final = r"^[0-9a-f]{16}\Z"
"""What a participant's browser draws, and sends again when the page is opened again."""

Code = Annotated[str, Meta(pattern=CODE)]
Number = Annotated[int, Meta(ge=0)]


class Enrolled(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="enrolled"):
    """A participant has agreed and has a number.

    Attributes:
        plan: SHA-256 of the plan.
        code: The participant's.
        participant: The number.
    """

    plan: str
    code: Code
    participant: Number


class Played(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="played"):
    """A participant has played a game to its end.

    Attributes:
        code: The participant's.
        game: Which of the participant's games, from 0.
        points: Of the team.
        soups: Delivered.
        steps: Played.
        late: Steps in which the partner's answer was not there in time.
        partner: The partner's SHA-256.
    """

    code: Code
    game: Number
    points: float
    soups: Number
    steps: Number
    late: Number
    partner: str


class Answered(msgspec.Struct, frozen=True, forbid_unknown_fields=True, tag="answered"):
    """A participant has answered the questions about a game.

    Attributes:
        code: The participant's.
        game: Which game, from 0.
        answers: Question -> the number on its scale.
    """

    code: Code
    game: Number
    answers: dict[str, int]


Event = Enrolled | Played | Answered


@dataclass
class Progress:
    """How far a participant is.

    Attributes:
        number: The participant's.
        played: Games that were played to their end, in order.
        answers: Game -> answers.
    """

    number: int
    played: list[Played]
    answers: dict[int, dict[str, int]]


class StudyLog:
    """The record of a study.

    Args:
        folder: The study's folder; the file in it is made when the first participant agrees.
        study: What is studied.

    Raises:
        StudyError: The file cannot be read, or is of another plan.
    """

    def __init__(self, folder: str | Path, study: Study) -> None:
        self.study = study
        self.participants: dict[str, Progress] = {}
        self._file = Path(folder) / FILE
        self._present: set[str] = set()
        for event in _read(self._file):
            if isinstance(event, Enrolled) and event.plan != study.sha256:
                raise StudyError(
                    f"{shown(self._file)} belongs to another version of the plan ({event.plan[:12]}…); give another "
                    "--output, or the plan as it was"
                )
            self._note(event)

    def enter(self, code: str) -> Progress:
        """Lets a participant in, who has a number already or gets one.

        A new participant gets the lowest number under which nobody has finished and nobody is present, so the place of
        one who has dropped out is filled again.

        Args:
            code: The participant's.
        """
        self._present.add(code)
        if code not in self.participants:
            taken = {one.number for code, one in self.participants.items() if self._is_held(code, one)}
            number = next(number for number in range(len(taken) + 1) if number not in taken)
            self._add(Enrolled(self.study.sha256, code, number))
        return self.participants[code]

    def is_present(self, code: str) -> bool:
        """Returns whether a participant's page is open."""
        return code in self._present

    def leave(self, code: str) -> None:
        """Notes that a participant's page was closed."""
        self._present.discard(code)

    def next_trial(self, code: str) -> Trial | None:
        """Returns a participant's next game, None after the last one."""
        progress = self.participants[code]
        trials = self.study.trials(progress.number)
        done = len(progress.played)
        return trials[done] if done < len(trials) else None

    def unanswered(self, code: str) -> int | None:
        """Returns the game that a participant was not asked about yet, None if there is none."""
        progress = self.participants[code]
        if not self.study.plan.questions:
            return None
        return next((one.game for one in progress.played if one.game not in progress.answers), None)

    def played(self, event: Played) -> None:
        """Notes a game that was played to its end."""
        self._add(event)

    def answered(self, code: str, answers: dict[str, int]) -> None:
        """Notes the answers about the last game.

        Raises:
            StudyError: There is no such game, or the answers are not those of the questions.
        """
        game, questions = self.unanswered(code), self.study.plan.questions
        if game is None:
            raise StudyError("there is no game to be asked about")
        if answers.keys() != questions.keys() or not all(1 <= answers[key] <= questions[key].points for key in answers):
            scales = ", ".join(f"{key} (1 to {question.points})" for key, question in questions.items())
            raise StudyError(f"answers are to be given for {scales}")
        self._add(Answered(code, game, answers))

    def _is_held(self, code: str, progress: Progress) -> bool:
        finished = len(progress.played) == len(self.study.trials(progress.number))
        return finished or code in self._present

    def _add(self, event: Event) -> None:
        self._note(event)
        self._file.parent.mkdir(parents=True, exist_ok=True)
        append_line(self._file, msgspec.json.encode(event))

    def _note(self, event: Event) -> None:
        match event:
            case Enrolled(code=code, participant=number):
                self.participants[code] = Progress(number, [], {})
            case Played(code=code):
                self.participants[code].played.append(event)
            case Answered(code=code, game=game, answers=answers):
                self.participants[code].answers[game] = answers


def _read(file: Path) -> Iterator[Event]:
    """Reads the events; the last line is left out if a killed program did not finish it, and cut off."""
    if not file.exists():
        return
    cut_unfinished_line(file)
    enrolled: set[str] = set()
    for number, line in enumerate(BytesIO(read_regular(file, MOST_BYTES, raises=StudyError)), start=1):
        where = f"{shown(file)}:{number}"
        event = cast(Event, parse_json(line, where, Event, StudyError))  # type: ignore[arg-type]
        if isinstance(event, Enrolled):
            enrolled.add(event.code)
        elif event.code not in enrolled:
            raise StudyError(f"{where}: of a participant who was not enrolled; the file was changed")
        yield event
