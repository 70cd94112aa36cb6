"""Defines `Scenario`, one edge case, and `Situation`, the same from one seat in the plain or the mirrored kitchen."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any, Final

from overcooked_bench.agents.mirror import mirror_actions, mirror_state
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import KitchenState
from overcooked_bench.scenarios.language.terms import Condition

if TYPE_CHECKING:
    from overcooked_bench.agents.behaviours.behaviour import Behaviour

SEATS: Final = (0, 1)
HORIZON: Final = 400
"""Steps of an episode; a scenario of the category `horizon` starts `budget` steps before its end, others at step 0."""

JointAction = tuple[int, int]


@dataclass(frozen=True, eq=False)
class Scenario:
    """One edge case. A is the tested agent, B its partner.

    Attributes:
        id: Its name, which is also its file's name.
        category: One of `CATEGORIES`.
        family: The family for the mean over families.
        layout: The plain kitchen.
        cooking: "auto" or "manual".
        state: The state in the picture, with A on seat 0.
        behaviour: The behaviour of B.
        accept: What has to hold at some step within the budget.
        never: What must not have held until then.
        budget: Steps, or None if the lock file or a search determines it.
        before: Joint actions (A, B) that are played before A is asked for the first time.
        pair: The name that it shares with the other half of its pair.
        tags: Words to select by.
        why: What a robust agent does here, and why.
        source: The file it was read from.
        drawn: B's behaviour as the file describes it.
    """

    id: str
    category: str
    family: str
    layout: Layout
    cooking: str
    state: KitchenState
    behaviour: "Behaviour"
    accept: Condition
    never: Condition | None
    budget: int | None
    before: tuple[JointAction, ...]
    pair: str | None
    tags: tuple[str, ...]
    why: str
    source: str
    drawn: Mapping[str, Any] = field(default_factory=dict, hash=False)

    def seated(self, seat: int, mirrored: bool = False) -> "Situation":
        """Returns the scenario with A on a seat, in the plain or the mirrored kitchen."""
        layout, state, behaviour = self.layout, self.state, self.behaviour
        accept, never, before = self.accept, self.never, self.before
        if mirrored:
            layout, state = layout.mirrored(), mirror_state(state, layout.width)
            behaviour = behaviour.mirrored(layout.width)
            accept = accept.mirrored(self.layout)
            never = never.mirrored(self.layout) if never else None
            before = tuple((int(a), int(b)) for a, b in (mirror_actions(joint) for joint in before))
        if seat:
            state = replace(state, chefs=(state.chefs[1], state.chefs[0]))
            before = tuple((b, a) for a, b in before)
        return Situation(self, seat, mirrored, layout, state, behaviour, accept, never, before)


@dataclass(frozen=True, eq=False)
class Situation:
    """A scenario from one seat, in the plain or the mirrored kitchen.

    Attributes:
        scenario: The scenario.
        seat: A's seat.
        mirrored: Whether the kitchen is the mirror image.
        layout: The kitchen.
        state: The state in the picture, A on `seat`; `before` has still to be played.
        behaviour: The behaviour of B, on the other seat; its clock starts after `before`.
        accept: What has to hold.
        never: What must not have held.
        before: Joint actions in the order of the seats.
    """

    scenario: Scenario
    seat: int
    mirrored: bool
    layout: Layout
    state: KitchenState
    behaviour: "Behaviour"
    accept: Condition
    never: Condition | None
    before: tuple[JointAction, ...]

    @property
    def id(self) -> str:
        """The scenario, the seat and the mirror image as one name."""
        return f"{self.scenario.id}-seat{self.seat}" + "-mirrored" * self.mirrored

    @property
    def partner_seat(self) -> int:
        """B's seat."""
        return 1 - self.seat

    @cached_property
    def counters(self) -> dict[Any, int]:
        """Everything that has to be counted: counter -> a count that is equivalent to any greater one."""
        never = self.never.counters if self.never else {}
        accept = self.accept.counters
        return {key: max(accept.get(key, 0), never.get(key, 0)) for key in {**accept, **never}}

    def first_state(self, budget: int) -> KitchenState:
        """Returns the state in the picture at the step of the episode at which it is played.

        Args:
            budget: Steps that A has.
        """
        late = self.scenario.category == "horizon"
        return replace(self.state, timestep=HORIZON - budget - len(self.before) if late else 0)
