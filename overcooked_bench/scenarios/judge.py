"""Examines a single run: what happened step by step, and which part of the condition failed."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from overcooked_bench.kitchen.codes import PICTURE_NAMES, STAY
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.scenarios.language.terms import Condition, Either
from overcooked_bench.scenarios.scenario import Situation
from overcooked_bench.scenarios.stage import Part, Stage


class Truth(NamedTuple):
    """A part of a condition during a run.

    Attributes:
        text: The part.
        first: The step at which it first held, None if it never did.
        last: Whether it held at the end.
    """

    text: str
    first: int | None
    last: bool

    def __str__(self) -> str:
        if self.first is None:
            return f"`{self.text}` never held"
        since = f"`{self.text}` held at step {self.first}"
        return since if self.last else f"{since}, and no more at the end"


class Run(NamedTuple):
    """A run, judged.

    Attributes:
        part: What was played.
        passed: The verdict.
        reached: The step at which `accept` held, None if it did not.
        spoiled: The step at which `never` held, None if it did not.
        accept: Each conjunct of `accept`; if it is a choice, each alternative as a whole.
        actions: A's and B's actions by seat, `before` first, up to the verdict.
        states: The state before each of them, and the last one.
    """

    part: Part
    passed: bool
    reached: int | None
    spoiled: int | None
    accept: tuple[Truth, ...]
    actions: tuple[tuple[int, int], ...]
    states: tuple[KitchenState, ...]

    def film(self, steps: int = 8, colour: bool = False, width: int = 100) -> str:
        """Draws the last steps side by side.

        Args:
            steps: Number of joint actions.
            colour: Whether to use a terminal's colours.
            width: Characters per line.
        """
        from overcooked_bench.rendering.text import film, side_by_side

        situation, first = self.part.situation, max(0, len(self.actions) - steps)
        names, frames = "AB" if situation.seat == 0 else "BA", []
        for number, state in enumerate(self.states[first:], start=first):
            time = number - len(situation.before)
            caption = [f"step {time}" if time >= 0 else f"{-time} before", "", ""]
            if number < len(self.actions):
                joint = self.actions[number]
                seats = {"A": situation.seat, "B": situation.partner_seat}
                caption[1:] = [f"{name} {_does(joint[seat])}" for name, seat in seats.items()]
            picture = film(situation.layout, state, colour=colour, legend=False, names=names)
            frames.append("\n".join([*caption, picture]))
        return side_by_side(frames, width)

    def why(self) -> str:
        """Returns a few lines: why the run failed, or when it passed."""
        budget = self.part.budget
        if self.passed:
            return f"passed at step {self.reached} of {budget}"
        if self.spoiled is not None:
            return f"`{self.part.situation.never}` (never) held at step {self.spoiled}"
        lines = [f"not reached within {budget} steps: {self.part.situation.accept}"]
        return "\n".join(lines + [f"  {truth}" for truth in self.accept])


def _does(action: int) -> str:
    """Returns "up" or "stays"."""
    return PICTURE_NAMES[action] + "s" * (action >= STAY)


def judge(situation: Situation, budget: int, own: Sequence[int]) -> Run:
    """Plays A's actions with the scenario's partner, and judges the run.

    Args:
        situation: What is played.
        budget: Steps that A has.
        own: A's actions from the first step on; A stays still after the last one.
    """
    stage = Stage([Part(situation, budget)])
    prelude = len(situation.before)
    accept, seen = _alternatives(situation.accept), []
    states, spoiled = [stage.kitchens.state(0)], None
    seen.append(stage.truth(0, accept) if not prelude else [])
    while not stage.over:
        time = stage.step - prelude
        stage.play(np.array([own[time] if 0 <= time < len(own) else STAY]))
        states.append(stage.kitchens.state(0))
        seen.append(stage.truth(0, accept) if stage.step >= prelude else [])
    if situation.never and stage.truth(0, [situation.never])[0]:
        spoiled = stage.step - prelude
    truths = []
    for index, condition in enumerate(accept):
        held = [bool(now) and now[index] for now in seen[prelude:]]
        truths.append(Truth(str(condition), held.index(True) if any(held) else None, held[-1]))
    return Run(
        part=Part(situation, budget),
        passed=bool(stage.passed[0]),
        reached=int(stage.reached[0]) if stage.passed[0] else None,
        spoiled=spoiled,
        accept=tuple(truths),
        actions=tuple((int(a), int(b)) for a, b in stage.actions[: stage.step, 0]),
        states=tuple(states),
    )


def replay(situation: Situation, budget: int, actions: ArrayLike) -> Run:
    """Judges a recorded run from its joint actions, `before` included.

    Args:
        situation: What was played.
        budget: Steps that A had.
        actions: (T, 2) joint actions by seat.
    """
    own = np.asarray(actions)[len(situation.before) :, situation.seat]
    return judge(situation, budget, [int(action) for action in own])


def _alternatives(accept: Condition) -> tuple[Condition, ...]:
    return accept.conditions if isinstance(accept, Either) else accept.conjuncts
