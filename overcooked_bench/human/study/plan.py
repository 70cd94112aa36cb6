"""`StudyPlan`: a study as its YAML file describes it, and the games of each participant.

A participant plays every condition once on every layout: one layout after the other, and on each of them the conditions
in an order of a Williams design.
"""

import hashlib
import random
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Annotated, Final, Literal

import msgspec
from msgspec import Meta

from overcooked_bench.agents.kinds import ANY_LAYOUT
from overcooked_bench.documents import LONGEST, parse_yaml
from overcooked_bench.errors import WrongUse
from overcooked_bench.files import NAME, read_text
from overcooked_bench.human.game import MOST_STEPS
from overcooked_bench.human.study.order import MOST, williams
from overcooked_bench.kitchen.layout import layout_names

Key = Annotated[str, Meta(pattern=rf"^{NAME}\Z", max_length=60)]
Words = Annotated[str, Meta(min_length=1, max_length=2000)]

PLAN: Final = "plan.yaml"
"""The copy of the plan in a study's folder."""
LETTERS: Final = "ABCDEFGHIJKLMNOPQRSTUVWXYZ"


class StudyError(WrongUse):
    """A study's plan or folder cannot be used; names the file and the key."""


class Question(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A question after each game, answered on a scale.

    Attributes:
        text: What participants read.
        low: What 1 means.
        high: What the highest number means.
        points: The highest number.
    """

    text: Words
    low: Words = "strongly disagree"
    high: Words = "strongly agree"
    points: Annotated[int, Meta(ge=2, le=11)] = 7


QUESTIONS: Final = {
    "fluency": Question(text="My partner and I worked fluently together."),
    "trust": Question(text="I could rely on my partner to do the right thing at the right time."),
}
"""What is asked by default, in the manner of two scales of Hoffman (2019), "Evaluating Fluency in Human-Robot
Collaboration": fluency, and trust in the partner. The wording is ours."""


class StudyPlan(msgspec.Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A study.

    Attributes:
        name: Its name, which files and records have.
        layouts: Shipped layouts.
        conditions: Condition -> the partner, a reference to an agent; `{layout}` stands for the layout's name. Neither
            is ever shown to a participant.
        seats: "balanced", or the seat of all participants.
        questions: Key -> the question, asked after each game.
        consent: What participants read besides what is recorded: who does the study, what for, whom to ask.
        pace: Milliseconds per step.
        horizon: Steps of a game.
        seed: Draws which condition is which of the design, and which letter stands for it.
    """

    name: Key
    layouts: Annotated[tuple[str, ...], Meta(min_length=1, max_length=20)]
    conditions: Annotated[dict[Key, Words], Meta(min_length=1, max_length=len(LETTERS))]
    seats: Literal["balanced", 0, 1] = "balanced"
    questions: Annotated[dict[Key, Question], Meta(max_length=10)] = msgspec.field(default_factory=QUESTIONS.copy)
    consent: Words
    pace: Annotated[float, Meta(ge=20, le=2000)] = 150
    horizon: Annotated[int, Meta(ge=1, le=MOST_STEPS)] = 400
    seed: Annotated[int, Meta(ge=0)] = 0

    def __post_init__(self) -> None:
        strange = sorted({*self.layouts} - {*layout_names()})
        if strange or len({*self.layouts}) < len(self.layouts):
            raise ValueError(f"layouts is {[*self.layouts]}; choose among {', '.join(layout_names())}, each once")
        if max(len(self.conditions), len(self.layouts)) > MOST:
            raise ValueError(f"more than {MOST} conditions or layouts")


@dataclass(frozen=True)
class Trial:
    """One game of a participant.

    Attributes:
        number: Which of the participant's games, from 0.
        layout: Where.
        condition: With whom, the plan's key.
        partner: The agent.
        seat: The participant's.
        label: What the participant is shown instead of the partner's name.
    """

    number: int
    layout: str
    condition: str
    partner: str
    seat: int
    label: str


@dataclass(frozen=True)
class Study:
    """A plan, and who plays what under it.

    Attributes:
        plan: The plan.
        sha256: Of the plan's file, hexadecimal.
    """

    plan: StudyPlan
    sha256: str

    @cached_property
    def cycle(self) -> int:
        """Participants after whom everything is balanced: orders, layouts and, if they are, seats."""
        orders, layouts = len(williams(len(self.plan.conditions))), len(williams(len(self.plan.layouts)))
        return orders * layouts * (2 if self.plan.seats == "balanced" else 1)

    def trials(self, participant: int) -> tuple[Trial, ...]:
        """Returns the games of a participant in their order; the same for the same plan and number.

        Args:
            participant: The number, from 0.
        """
        plan = self.plan
        drawn = random.Random(f"{plan.seed}/{plan.name}")
        conditions, layouts = list(plan.conditions), list(plan.layouts)
        drawn.shuffle(conditions)
        drawn.shuffle(layouts)
        own = random.Random(f"{plan.seed}/{plan.name}/{participant}")
        letters = dict(zip(conditions, own.sample(LETTERS[: len(conditions)], len(conditions)), strict=True))
        orders, sequences = williams(len(conditions)), williams(len(layouts))
        row, cycles = participant // len(sequences), participant // (len(orders) * len(sequences))
        trials: list[Trial] = []
        for block, place in enumerate(sequences[participant % len(sequences)]):
            for position, index in enumerate(orders[(row + block) % len(orders)]):
                layout, condition = layouts[place], conditions[index]
                partner = plan.conditions[condition].replace(ANY_LAYOUT, layout)
                seat = (cycles + block + position) % 2 if plan.seats == "balanced" else plan.seats
                trials.append(Trial(len(trials), layout, condition, partner, seat, f"Partner {letters[condition]}"))
        return tuple(trials)


def read_study(file: str | Path) -> Study:
    """Reads a study's plan.

    Raises:
        StudyError: The file cannot be read, or a key is wrong; names it.
    """
    text = read_text(file, LONGEST, raises=StudyError)
    plan = parse_yaml(text, str(file), StudyError).convert(StudyPlan)
    return Study(plan, hashlib.sha256(text.encode()).hexdigest())
