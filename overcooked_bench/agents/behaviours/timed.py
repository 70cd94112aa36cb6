"""Behaviours that depend on the clock: fixed actions, pauses, switches, noise."""

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
"""The behaviour that never does anything."""


@dataclass(frozen=True)
class Script(Behaviour):
    """Plays a fixed list of actions, then another behaviour.

    Attributes:
        actions: One action per step.
        then: What follows; its clock starts at 0 there.
    """

    actions: tuple[int, ...]
    then: Behaviour = FROZEN

    @property
    def sight(self) -> Sight:
        """Returns the sight of `then`; the actions depend on nothing."""
        return self.then.sight

    @property
    def floor(self) -> frozenset[Position]:
        """Returns the cells of `then`."""
        return self.then.floor

    def phase(self, t: int) -> int:
        """Returns the time, as the actions depend on it."""
        start = len(self.actions)
        return t if t < start else start + self.then.phase(t - start)

    def decide(self, scene: Scene) -> int:
        """Returns the next action."""
        start = len(self.actions)
        return self.actions[scene.time] if scene.time < start else ask(self.then, scene, scene.time - start)


@dataclass(frozen=True)
class Loop(Behaviour):
    """Repeats a fixed list of actions."""

    actions: tuple[int, ...]

    def phase(self, t: int) -> int:
        """Returns the position in the list."""
        return t % len(self.actions)

    def decide(self, scene: Scene) -> int:
        """Returns the next action."""
        return self.actions[scene.time]


@dataclass(frozen=True)
class Switch(Behaviour):
    """Switches from one behaviour to another at a given time.

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
        """Returns what either depends on."""
        return self.before.sight | self.after.sight

    @property
    def floor(self) -> frozenset[Position]:
        """Returns the cells of both."""
        return self.before.floor | self.after.floor

    def phase(self, t: int) -> int:
        """Returns the time before the switch, and the second behaviour's phase after it."""
        return t if t < self.at else self.at + self.after.phase(t - self.at)

    def decide(self, scene: Scene) -> int:
        """Asks the behaviour whose turn it is."""
        if scene.time < self.at:
            return ask(self.before, scene, scene.time)
        return ask(self.after, scene, scene.time - self.at)


@dataclass(frozen=True)
class Noisy(Behaviour):
    """Sometimes plays a uniformly random action instead of the wanted one.

    Attributes:
        wanted: The behaviour without noise.
        probability: Probability of a random action in each step.
        seed: Seed of the draws, which depend on it and the time alone.
    """

    wanted: Behaviour
    probability: float
    seed: int

    @property
    def sight(self) -> Sight:
        """Returns what the behaviour without noise depends on."""
        return self.wanted.sight

    @property
    def floor(self) -> frozenset[Position]:
        """Returns the cells of the behaviour without noise."""
        return self.wanted.floor

    def phase(self, t: int) -> int:
        """Returns the time, as every step has its own draw."""
        return t

    def decide(self, scene: Scene) -> int:
        """Draws a random action or asks the behaviour."""
        draw = float(uniforms(np.array([self.seed], np.uint64), scene.time)[0])
        if draw < self.probability:
            return int(draw / self.probability * NUM_ACTIONS)
        return ask(self.wanted, scene, scene.time)


def ask(behaviour: Behaviour, scene: Scene, t: int) -> int:
    """Asks a behaviour with another clock."""
    return behaviour.decide(replace(scene, time=behaviour.phase(t)))
