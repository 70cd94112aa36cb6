"""Small games for tests: of random joint actions, and of two agents."""

from typing import Any

import numpy as np

from overcooked_bench import KitchenState, load_agent
from overcooked_bench.agents.seated import Seated
from overcooked_bench.evaluation.games.play import make_kitchens, play
from overcooked_bench.human.game import Game, Player
from overcooked_bench.human.games import record
from overcooked_bench.kitchen.kitchens import Kitchens

PEOPLE = Player("human", "a person"), Player("human", "another person")


def start_of(layout: str, seed: int, cooking: str = "auto") -> KitchenState:
    kitchens = Kitchens(layout, 1, cooking=cooking, object_probability=0.5)
    kitchens.reset(seed=seed)
    return kitchens.state(0)


def random_game(layout: str = "cramped_room", steps: int = 30, seed: int = 0, **more: Any) -> Game:
    """Random actions hardly ever deliver; `interact` and walking are likelier than staying."""
    actions = np.random.default_rng(seed).choice(6, size=(steps, 2), p=[0.17, 0.17, 0.17, 0.17, 0.02, 0.3])
    facts = {"seats": PEOPLE, "source": "made up", "start": start_of(layout, seed, more.get("cooking", "auto"))}
    return record(layout, actions, **{**facts, **more})


def agents_games(
    layout: str = "cramped_room",
    agents: tuple[str, str] = ("greedy", "greedy"),
    number: int = 1,
    horizon: int = 120,
    groups: tuple[str | None, ...] = (None,),
    start: str = "standard",
) -> list[Game]:
    """Games of two agents; game i passes as one of the i-th group of people."""
    rows = np.arange(number)
    parties = [Seated(load_agent(name, layout), name, rows, np.full(number, k)) for k, name in enumerate(agents)]
    kitchens = make_kitchens(layout, number, parties, horizon=horizon, start=start)
    kitchens.reset(seed=0)
    played = play(kitchens, parties, np.arange(2 * number, dtype=np.uint64).reshape(number, 2))
    people = [Player("human", "a person") if groups[0] else Player("agent", name) for name in agents]
    return [
        record(
            layout,
            played.actions[:, row],
            start=played.starts[row],
            seats=(people[0], people[1]),
            source="made up",
            group=groups[row % len(groups)],
        )
        for row in range(number)
    ]
