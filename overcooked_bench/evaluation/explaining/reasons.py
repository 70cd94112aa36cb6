"""Says why a pair failed from a moment on: what the agent, its partner and both together do from the same state.

Axes: R repeats.
"""

from collections.abc import Sequence
from typing import Annotated, Final, Literal, NamedTuple

import msgspec
import numpy as np
from msgspec import Meta

Pairing = Literal["pair", "agent", "partner", "greedy"]
PAIRINGS: Final[tuple[Pairing, ...]] = ("pair", "agent", "partner", "greedy")
"""Who plays on from a moment: the scored agent with its partner, the agent with a copy of itself, the partner with a
copy of itself, and two copies of `greedy`, which show what the state allows."""

REPEATS: Final = 4
"""Times that each of the first three plays on from a moment, with other random streams. `greedy` plays once: its random
draws only resolve ties and collisions."""

HALF: Final = 0.5
"""Share of what another pairing delivers below which a pairing does badly."""

LEAST: Final = 1.0
"""Soups that have to be within reach for a moment to say anything."""

Reason = Literal["works", "clash", "inexperience", "weak partner", "neither", "nothing"]


class Meaning(NamedTuple):
    """What a reason is called, and what it means.

    Attributes:
        heading: In tables.
        meaning: In a sentence.
    """

    heading: str
    meaning: str


REASONS: Final[dict[Reason, Meaning]] = {
    "works": Meaning("works", "the pair delivers at least half of what any of the four pairings does"),
    "clash": Meaning(
        "clash of\nconventions", "each does well with a copy of itself; together they deliver less than half of that"
    ),
    "inexperience": Meaning(
        "outside its\nexperience", "the partner does well with a copy of itself, the agent does not with one of itself"
    ),
    "weak partner": Meaning(
        "weak\npartner", "the agent does well with a copy of itself, the partner does not with one of itself"
    ),
    "neither": Meaning("neither\nalone", "neither does well with a copy of itself, and greedy does"),
    "nothing": Meaning("nothing\nto gain", "nobody delivers a soup from here; not counted in any share"),
}
FAILURES: Final[tuple[Reason, ...]] = ("clash", "inexperience", "weak partner", "neither")
"""Reasons of moments from which the pair fails."""


Repeats = Annotated[tuple[float, ...], Meta(min_length=1)]


class Soups(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Soups that were paid for from a moment on, in soups of the layout's own value.

    Attributes:
        pair: By the agent and its partner, in each of R repeats.
        agent: By the agent and a copy of itself.
        partner: By the partner and a copy of itself.
        greedy: By two copies of `greedy`, once.
    """

    pair: Repeats
    agent: Repeats
    partner: Repeats
    greedy: Repeats

    def mean(self, pairing: Pairing) -> float:
        """Returns the mean over repeats."""
        return float(np.mean(getattr(self, pairing)))

    @property
    def best(self) -> float:
        """The most that any pairing delivers on average: what is known to be within reach."""
        return max(self.mean(pairing) for pairing in PAIRINGS)

    @property
    def missed(self) -> float:
        """Soups that the pair delivers fewer than the best."""
        return self.best - self.mean("pair")


def reason_for(soups: Soups) -> Reason:
    """Returns the reason of a moment.

    The pair *fails* if it delivers less than half of the best of the four pairings from this state. Then, an agent does
    *well alone*, with a copy of itself, if it delivers more than twice what the pair does, at least half of what the
    other one does alone, and a soup at least. If both do, it is a clash; if one does, the other is to blame; if none
    does, it is neither. Why so:

    - At most five soups fit into 100 steps, and how many depends on the state: from three full pots they come faster
      than after a soup was just served. A fixed number would blame somebody for the state, so what is known to be
      within reach from this very state is the measure.
    - The best of the agent's and the partner's pairings alone would call a state fine from which all of them fail.
      `greedy` belongs to neither, so it shows that there was more; and the others count because it is not the best
      everywhere (.74 of the best known responders on counter_circuit).
    - Half is where the headline H50 draws its line, too: an agent works with a partner if it reaches half of what is
      known to be possible.
    - To do well alone is measured against the pair, not against `greedy`. Many agents deliver about half as much as
      `greedy` with copies of themselves; a line there would be crossed by chance, in four games of one or two soups,
      and two copies of one agent would clash with each other in every tenth moment. As it is, a clash needs two
      differences of a factor of two in the same direction.
    - A pair that delivers as much as a slow partner does with itself does not clash with it; the partner is weak.
    - Where less than one soup is within reach, nothing can be missed, and the moment is not counted.

    A single moment is still a matter of a few soups, and its reason may be wrong. What counts are shares over many
    moments, with their intervals.
    """
    pair, agent, partner = (soups.mean(pairing) for pairing in PAIRINGS[:3])
    if soups.best < LEAST:
        return "nothing"
    if pair >= HALF * soups.best:
        return "works"
    level = max(LEAST, HALF * max(agent, partner))
    agent_does, partner_does = (alone >= level and pair < HALF * alone for alone in (agent, partner))
    if agent_does and partner_does:
        return "clash"
    if agent_does:
        return "weak partner"
    return "inexperience" if partner_does else "neither"


def typical(soups: Sequence[float]) -> int:
    """Returns the repeat whose soups are nearest to the mean over repeats, the first of several."""
    values = np.asarray(soups)
    return int(np.abs(values - values.mean()).argmin())
