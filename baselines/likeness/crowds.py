"""What people, their proxies and self-play agents do in the kitchen, each by itself and all together."""

from collections.abc import Sequence
from itertools import permutations
from typing import NamedTuple

import msgspec

from overcooked_bench.agents.policies.policy import Policy
from overcooked_bench.human.conduct import Conduct, conduct
from overcooked_bench.human.game import Game

from ..cloning.played import EPISODES, HORIZON, played


class Length(NamedTuple):
    """How much is played.

    Attributes:
        episodes: For each pairing of agents.
        horizon: Steps of each.
    """

    episodes: int = EPISODES
    horizon: int = HORIZON


class Crowd(NamedTuple):
    """Several pairs of people, or several pairings of agents, on one layout.

    Attributes:
        all: What they do together; intervals are over the pairs or pairings.
        each: What each of them does.
    """

    all: Conduct
    each: tuple[Conduct, ...]


def people(games: Sequence[Game]) -> Crowd:
    """Describes recorded games of one layout."""
    pairs = sorted({str(game.group) for game in games})
    return Crowd(conduct(games), tuple(conduct([game for game in games if game.group == pair]) for pair in pairs))


def with_themselves(policies: Sequence[Policy], length: Length) -> Crowd:
    """Plays each agent with itself."""
    return _crowd([(policy, policy) for policy in policies], length)


def with_each_other(policies: Sequence[Policy], length: Length) -> Crowd | None:
    """Plays each agent with every other one, in both seats; None for fewer than two."""
    return _crowd(list(permutations(policies, 2)), length) if len(policies) > 1 else None


def _crowd(pairings: Sequence[tuple[Policy, Policy]], length: Length) -> Crowd:
    found = [
        [msgspec.structs.replace(game, group=str(k)) for game in played(pairing, *length)]
        for k, pairing in enumerate(pairings)
    ]
    return Crowd(conduct([game for games in found for game in games]), tuple(map(conduct, found)))
