"""How well proxies foretell people, beside guesses and self-play agents."""

from collections.abc import Callable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from overcooked_bench.agents.policies.policy import Policy
from overcooked_bench.estimate import Estimate, t_interval
from overcooked_bench.human.people import SETS

from ..cloning.examples import Examples
from ..cloning.likelihood import Foretold, foretell, frequencies, last_action, uniform
from .proxies import Proxy, both_stages, staged

Pairwise = Mapping[str, Foretold]
"""Pair of people -> how well one guess foretells that pair."""

UNIFORM, FREQUENCIES, LAST = "uniform", "action frequencies", "last action"
CLONES, REGULARISED, SELF_PLAY = "clones", "regularised", "self-play agents"


class Foretelling(NamedTuple):
    """How well the people of a layout are foretold from the people of one set.

    Attributes:
        others: Who guesses -> for each of its guessers, the pairs of the other set; nothing was chosen on them.
        held_out: The same on the pairs of the set itself that a proxy did not learn from; cloning stopped, and the
            coefficient was chosen, by them. Guesses know the pairs that the proxy learned from.
        costs: For each regularised proxy, pair of the other set -> its nats less those of its clone.
        own_costs: The same on its held-out pairs.
    """

    others: Mapping[str, Sequence[Pairwise]]
    held_out: Mapping[str, Sequence[Pairwise]]
    costs: Sequence[Mapping[str, float]]
    own_costs: Sequence[Mapping[str, float]]


def by_pair(judge: Callable[[Examples], Foretold], rows: Examples) -> Pairwise:
    """Judges a guess on each pair of people."""
    return {pair: judge(rows.of([pair])) for pair in rows.people}


def foretelling(rows: Callable[[str], Examples], proxies: Sequence[Proxy], self_play: Sequence[Policy]) -> Foretelling:
    """Judges the proxies of one set of people on one layout.

    Args:
        rows: Name of an observation -> what all people of the layout saw so and did.
        proxies: Both stages, one at least.
        self_play: Agents to compare them with.
    """

    def known_by(policy: Policy) -> Pairwise:
        seen = rows(policy.architecture.observation)
        return by_pair(lambda some: foretell(policy, some), seen)

    everybody = rows(proxies[0].policy.architecture.observation)
    own = [pair for pair in everybody.people if pair in SETS[proxies[0].pairs]]
    strange = [pair for pair in everybody.people if pair not in own]
    known, kept = everybody.of(own), staged(proxies, "clone")
    judged = {proxy.name: known_by(proxy.policy) for proxy in proxies}
    alone = [known_by(policy) for policy in self_play]
    guesses: dict[str, Callable[[Examples, Examples], Foretold]] = {
        UNIFORM: lambda known, some: uniform(some),
        FREQUENCIES: frequencies,
        LAST: last_action,
    }

    def guessed(guess: Callable[[Examples, Examples], Foretold], known: Examples, pairs: Sequence[str]) -> Pairwise:
        return by_pair(lambda some: guess(known, some), everybody.of(pairs))

    others = {name: [guessed(guess, known, strange)] for name, guess in guesses.items()}
    held_out = {
        name: [guessed(guess, everybody.of(proxy.drawn), proxy.held_out) for proxy in kept]
        for name, guess in guesses.items()
    }
    for name, stage in ((CLONES, "clone"), (REGULARISED, "regularised")):
        others[name] = [_of(judged[proxy.name], strange) for proxy in staged(proxies, stage)]
        held_out[name] = [_of(judged[proxy.name], proxy.held_out) for proxy in staged(proxies, stage)]
    others[SELF_PLAY] = [_of(one, strange) for one in alone]
    held_out[SELF_PLAY] = [_of(one, own) for one in alone]
    pairs_of = both_stages(proxies)
    costs = [_less(judged[after.name], judged[before.name], strange) for before, after in pairs_of]
    own_costs = [_less(judged[after.name], judged[before.name], after.held_out) for before, after in pairs_of]
    return Foretelling(others, held_out, costs, own_costs)


def nats(guessers: Sequence[Pairwise]) -> Estimate:
    """Returns the mean over people of the mean over guessers, with its interval over pairs of people."""
    return over_pairs([{pair: found.nats for pair, found in one.items()} for one in guessers])


def accuracy(guessers: Sequence[Pairwise]) -> float:
    """Returns the share of steps on which the likeliest action was the one taken; people weigh the same."""
    return over_pairs([{pair: found.accuracy for pair, found in one.items()} for one in guessers]).value


def over_pairs(numbers: Sequence[Mapping[str, float]]) -> Estimate:
    """Returns the mean over pairs of people, of the means over all who have a number for the pair."""
    pairs = sorted({pair for one in numbers for pair in one})
    return t_interval([float(np.mean([one[pair] for one in numbers if pair in one])) for pair in pairs])


def _of(judged: Pairwise, pairs: Sequence[str]) -> Pairwise:
    return {pair: judged[pair] for pair in pairs}


def _less(one: Pairwise, other: Pairwise, pairs: Sequence[str]) -> dict[str, float]:
    return {pair: one[pair].nats - other[pair].nats for pair in pairs}
