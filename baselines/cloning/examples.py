"""What people saw and did in recorded games, as rows that a network learns from.

Axes: N rows, one for each step of a game and each person in it, L live inputs.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from overcooked_bench.agents.mirror import mirror_actions
from overcooked_bench.human.game import Game
from overcooked_bench.human.replay import replay
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import find_observation


@dataclass(frozen=True)
class Examples:
    """Rows of some games: game by game, then its mirror image if that counts, chef by chef, step by step.

    Attributes:
        seen: (N, L) live inputs of an observation before each step.
        actions: (N,) int64, what the chef did.
        returns: (N,) float32, discounted points that the pair earned from this step on.
        pairs: (N,) of text, the group of people.
        firsts: (N,) bool, whether the row is a game's first step.
    """

    seen: torch.Tensor
    actions: torch.Tensor
    returns: torch.Tensor
    pairs: NDArray[np.str_]
    firsts: NDArray[np.bool_]

    def __len__(self) -> int:
        return len(self.actions)

    @property
    def people(self) -> tuple[str, ...]:
        """The groups of people, sorted."""
        return tuple(sorted(set(self.pairs.tolist())))

    def of(self, people: Sequence[str]) -> "Examples":
        """Returns the rows of some groups; of one that is named k times, k times."""
        rows = np.concatenate([np.flatnonzero(self.pairs == name) for name in people])
        chosen = torch.from_numpy(rows)
        return Examples(
            self.seen[chosen], self.actions[chosen], self.returns[chosen], self.pairs[rows], self.firsts[rows]
        )


def examples(games: Sequence[Game], layout: str, observation: str, gamma: float) -> Examples:
    """Replays games and keeps what the people in them saw and did.

    On a layout that is its own mirror image each game also counts mirrored, if the observation can be mirrored.

    Args:
        games: Of one layout, each with a person in it.
        layout: The layout, as `Layout.load` takes it.
        observation: Name of an observation.
        gamma: Discount factor of `Examples.returns` per step.
    """
    kitchen, shown_as = Layout.load(layout), find_observation(observation)
    live = shown_as.live(kitchen).places
    views = [False, True] if _is_symmetric(kitchen) and shown_as.can_mirror else [False]
    shown = [np.empty((len(views), game.steps, 2, len(live)), shown_as.dtype) for game in games]
    points = [np.zeros(game.steps, np.float32) for game in games]
    for moment in replay(games, observations=[observation]):
        observed = moment.observe(observation)
        where = list(zip(moment.games.tolist(), moment.steps.tolist(), strict=True))
        for k, mirror in enumerate(views):
            seen = (shown_as.mirrored(observed) if mirror else observed).reshape(len(observed), 2, -1)[..., live]
            for (game, step), row in zip(where, seen, strict=True):
                shown[game][k, step] = row
        for (game, step), earned in zip(where, moment.play().soup_reward.sum(axis=1), strict=True):
            points[game][step] = earned
    columns: list[tuple[NDArray[Any], ...]] = []
    for recorded, seen, brought in zip(games, shown, points, strict=True):
        returns, first = _discounted(brought, gamma), np.arange(recorded.steps) == 0
        who = np.full(recorded.steps, recorded.group or "-")
        for k, mirror in enumerate(views):
            actions = recorded.joint_actions().astype(np.int64)
            actions = mirror_actions(actions) if mirror else actions
            columns += [(seen[k, :, chef], actions[:, chef], returns, who, first) for chef in people_in(recorded)]
    seen, done, returns, pairs, firsts = (np.concatenate(column) for column in zip(*columns, strict=True))
    return Examples(torch.from_numpy(seen), torch.from_numpy(done), torch.from_numpy(returns), pairs, firsts)


def people_in(game: Game) -> list[int]:
    """Returns the seats of a game on which people sat."""
    return [chef for chef, player in enumerate(game.seats) if player.kind == "human"]


def _is_symmetric(layout: Layout) -> bool:
    return layout.mirrored().rows == layout.rows


def _discounted(points: NDArray[np.float32], gamma: float) -> NDArray[np.float32]:
    returns, ahead = np.zeros_like(points), 0.0
    for t in range(len(points) - 1, -1, -1):
        returns[t] = ahead = points[t] + gamma * ahead
    return returns
