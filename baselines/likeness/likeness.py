"""`Likeness`: the proxies of one set of people on one layout, beside the people themselves, and the gates."""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Final, NamedTuple

import numpy as np

from overcooked_bench.estimate import Estimate
from overcooked_bench.human.game import Game
from overcooked_bench.human.people import SETS

from ..cloning import sweep
from ..cloning.examples import Examples, examples
from .crowds import Crowd, Length, people, with_each_other, with_themselves
from .foretold import CLONES, FREQUENCIES, REGULARISED, SELF_PLAY, Foretelling, foretelling, nats
from .proxies import Proxy, self_play_agents, staged

PEOPLE: Final = "people"
OTHERS: Final = "people of the other set"
EACH_OTHER: Final = "regularised, each other"
MOST_IDLE: Final = 100 * sweep.MOST_IDLE
"""Points of the idle share that a proxy may be away from people's."""
SOUPS: Final = (80.0, 120.0)
"""Percent of people's soups that a regularised proxy reaches with itself."""
SOUPS_EACH_OTHER: Final = (60.0, 130.0)
"""And with another one of the same people."""


class Likeness(NamedTuple):
    """The proxies of one set of people on one layout.

    Attributes:
        layout: Where.
        pairs: The set, A or B.
        proxies: Both stages.
        foretelling: How well they foretell people.
        crowds: Who -> what they do; `people` first.
    """

    layout: str
    pairs: str
    proxies: Sequence[Proxy]
    foretelling: Foretelling
    crowds: Mapping[str, Crowd]

    @property
    def coefficients(self) -> tuple[float, ...]:
        """Those of the regularised proxies."""
        return tuple(sorted({proxy.coefficient for proxy in staged(self.proxies, "regularised")}))


class Gate(NamedTuple):
    """A bound that the mean over some proxies is to keep.

    Attributes:
        name: What is bounded.
        values: One for each proxy, or pairing of proxies.
        low: Least mean.
        high: Greatest mean.
        text: How to write a value.
    """

    name: str
    values: tuple[float, ...]
    low: float
    high: float
    text: str

    @property
    def passed(self) -> bool:
        """Whether the mean is within the bounds."""
        return self.low <= float(np.mean(self.values)) <= self.high

    @property
    def within(self) -> int:
        """How many of the values are."""
        return sum(self.low <= value <= self.high for value in self.values)


def likenesses(games: Sequence[Game], layout: str, proxies: Sequence[Proxy], length: Length) -> list[Likeness]:
    """Judges the proxies of a layout, those of each set of people apart.

    Args:
        games: Of people of both sets, on this layout.
        layout: Its name.
        proxies: Of one set or both.
        length: How much they play.
    """

    @cache
    def rows(observation: str) -> Examples:
        return examples(games, layout, observation, 1.0)

    alone = self_play_agents(layout)
    self_play = with_themselves(alone, length)
    recorded = {name: people([game for game in games if game.group in SETS[name]]) for name in SETS}
    found = []
    for name, other in (("A", "B"), ("B", "A")):
        ours = [proxy for proxy in proxies if proxy.pairs == name]
        if not ours:
            continue
        crowds = {PEOPLE: recorded[name], OTHERS: recorded[other]}
        for who, stage in ((CLONES, "clone"), (REGULARISED, "regularised")):
            if policies := [proxy.policy for proxy in staged(ours, stage)]:
                crowds[who] = with_themselves(policies, length)
        together = with_each_other([proxy.policy for proxy in staged(ours, "regularised")], length)
        if together is not None:
            crowds[EACH_OTHER] = together
        crowds[SELF_PLAY] = self_play
        found.append(Likeness(layout, name, ours, foretelling(rows, ours, alone), crowds))
    return found


def gates(one: Likeness) -> list[Gate]:
    """Computes which bounds the proxies of a set keep on a layout; a bound on proxies that are not there is left out.

    They foretell the people of the other set better than action frequencies do, stay about as often as their people,
    deliver about as many soups, and are little less likely to do what their held-out people do than their clones are.
    """
    told = one.foretelling
    guess = nats(told.others[FREQUENCIES]).value
    those = one.crowds[PEOPLE].all

    def of(who: str, number: Callable[[Crowd], list[float]]) -> tuple[float, ...]:
        return tuple(number(one.crowds[who])) if who in one.crowds else ()

    def stays(crowd: Crowd) -> list[float]:
        return [100 * (each.idle.value - those.idle.value) for each in crowd.each]

    def shares(crowd: Crowd) -> list[float]:
        return [100 * share(each.soups, those.soups) for each in crowd.each]

    asked = [
        *(
            Gate(f"{who}: nats", tuple(nats([each]).value - guess for each in told.others[who]), -np.inf, 0, "{:+.2f}")
            for who in (CLONES, REGULARISED)
        ),
        *(
            Gate(f"{who}: idle", of(who, stays), -MOST_IDLE, MOST_IDLE, "{:+.0f} points")
            for who in (CLONES, REGULARISED)
        ),
        Gate(f"{REGULARISED}: soups", of(REGULARISED, shares), *SOUPS, "{:.0f} %"),
        Gate(f"{EACH_OTHER}: soups", of(EACH_OTHER, shares), *SOUPS_EACH_OTHER, "{:.0f} %"),
        Gate(
            f"{REGULARISED}: cost",
            tuple(float(np.mean([*each.values()])) for each in told.own_costs),
            -np.inf,
            sweep.MOST_NATS,
            "{:+.3f}",
        ),
    ]
    return [gate for gate in asked if gate.values]


def share(soups: Estimate, of: Estimate) -> float:
    """Returns soups as a share of others; not a number if those are none."""
    return soups.value / of.value if of.value else float("nan")
