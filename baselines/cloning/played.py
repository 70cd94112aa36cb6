"""Games of frozen policies in the form of recorded games, so that agents and people are described by the same code."""

import hashlib
from typing import Final

import msgspec
import numpy as np

from overcooked_bench.agents.policies.neural import NeuralAgent
from overcooked_bench.agents.policies.policy import Policy
from overcooked_bench.agents.seated import Seated
from overcooked_bench.agents.threads import one_thread
from overcooked_bench.evaluation.games.play import make_kitchens, play
from overcooked_bench.evaluation.games.streams import stream_key
from overcooked_bench.human.game import Game, Player, letters_of
from overcooked_bench.human.games import record_all

EPISODES: Final = 20
HORIZON: Final = 1200
"""Steps of an episode, about those of the games of 2019."""


def played(pair: tuple[Policy, Policy], episodes: int = EPISODES, horizon: int = HORIZON) -> list[Game]:
    """Plays two frozen policies with each other from the layout's standard start; actions are sampled.

    Args:
        pair: Who sits on seats 0 and 1; the same policy twice plays with itself.
        episodes: Number of games.
        horizon: Steps of each.
    """
    said = pair[0].architecture
    agents = [NeuralAgent(policy) for policy in pair]
    rows = np.arange(episodes)
    parties = [Seated(agent, f"seat {seat}", rows, np.full(episodes, seat)) for seat, agent in enumerate(agents)]
    kitchens = make_kitchens(said.layout, episodes, parties, cooking=said.cooking, start="standard", horizon=horizon)
    kitchens.reset(seed=0)
    names = "/".join(policy.sha256 for policy in pair)
    salt = int.from_bytes(hashlib.sha256(names.encode()).digest()[:4], "big")
    streams = [[stream_key("likeness", salt, i, seat) for seat in range(2)] for i in range(episodes)]
    with one_thread():
        games = play(kitchens, parties, np.array(streams, np.uint64))
    seats = tuple(Player("agent", policy.name, policy.sha256) for policy in pair)
    draft = Game(
        layout=said.layout,
        cooking=said.cooking,
        horizon=horizon,
        actions=("S", "S"),
        seats=(seats[0], seats[1]),
        soups=(),
        source="overcooked_bench",
    )
    return record_all(
        [msgspec.structs.replace(draft, actions=letters_of(games.actions[:, i])) for i in range(episodes)]
    )
