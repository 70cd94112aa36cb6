"""Behaviours that go by the clock: actions played blindly, breaks, changes of mind, noise."""

from dataclasses import dataclass, replace
from typing import Final

import numpy as np

from overcooked_bench.agents.agent import uniforms
from overcooked_bench.agents.behaviours.behaviour import Behaviour, Scene, Sight
from overcooked_bench.kitchen.codes import NUM_ACTIONS, STAY, Position


@dataclass(frozen=True)
class Frozen(Behaviour):
    """Never does anything."""

    def decide(self, scene: Scene) -> int:
        """Stays."""
        return STAY


FROZEN: Final = Frozen()
"""The one who never does anything."""


@dataclass(frozen=True)
class Script(Behaviour):
    """Plays a list of actions whatever happens, then another behaviour.

    Attributes:
        actions: One action a step.
        then: What follows; its clock starts at 0 there.
    """

    actions: tuple[int, ...]
    then: Behaviour = FROZEN

    @property
    def sight(self) -> Sight:
        """What follows may look about; the actions do not."""
        return self.then.sight

    @property
    def floor(self) -> frozenset[Position]:
        """Those of what follows."""
        return self.then.floor

    def phase(self, t: int) -> int:
        """The actions go by the time."""
        start = len(self.actions)
        return t if t < start else start + self.then.phase(t - start)

    def decide(self, scene: Scene) -> int:
        """Gives the next action."""
        start = len(self.actions)
        return self.actions[scene.time] if scene.time < start else ask(self.then, scene, scene.time - start)


@dataclass(frozen=True)
class Loop(Behaviour):
    """Plays a list of actions over and over, whatever happens."""

    actions: tuple[int, ...]

    def phase(self, t: int) -> int:
        """The place in the list."""
        return t % len(self.actions)

    def decide(self, scene: Scene) -> int:
        """Gives the next action."""
        return self.actions[scene.time]


@dataclass(frozen=True)
class Switch(Behaviour):
    """Does one thing before a time and another from then on.

    Attributes:
        at: The first step of the second behaviour, whose clock starts at 0 there.
        before: The first behaviour.
        after: The second behaviour.
    """

    at: int
    before: Behaviour
    after: Behaviour

    @property
    def sight(self) -> Sight:
        """What either looks at."""
        return self.before.sight | self.after.sight

    @property
    def floor(self) -> frozenset[Position]:
        """Those of either."""
        return self.before.floor | self.after.floor

    def phase(self, t: int) -> int:
        """The time before the change, and how the second one counts it."""
        return t if t < self.at else self.at + self.after.phase(t - self.at)

    def decide(self, scene: Scene) -> int:
        """Asks the one whose turn it is."""
        if scene.time < self.at:
            return ask(self.before, scene, scene.time)
        return ask(self.after, scene, scene.time - self.at)


@dataclass(frozen=True)
class Noisy(Behaviour):
    """Plays a uniformly random action now and then instead of what it wants.

    Attributes:
        wanted: The behaviour.
        probability: Of a random action in each step.
        seed: The draws depend on it and the time alone.
    """

    wanted: Behaviour
    probability: float
    seed: int

    @property
    def sight(self) -> Sight:
        """The behaviour's own."""
        return self.wanted.sight

    @property
    def floor(self) -> frozenset[Position]:
        """The behaviour's own."""
        return self.wanted.floor

    def phase(self, t: int) -> int:
        """Every step has its own draw."""
        return t

    def decide(self, scene: Scene) -> int:
        """Draws, then asks the behaviour."""
        draw = float(uniforms(np.array([self.seed], np.uint64), scene.time)[0])
        if draw < self.probability:
            return int(draw / self.probability * NUM_ACTIONS)
        return ask(self.wanted, scene, scene.time)


def ask(behaviour: Behaviour, scene: Scene, t: int) -> int:
    """Asks one behaviour on behalf of another, with a clock of its own."""
    return behaviour.decide(replace(scene, time=behaviour.phase(t)))
