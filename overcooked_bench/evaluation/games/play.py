"""Plays episodes in one batch: each agent sees only its own seats, and every joint action is recorded.

Axes: N kitchens (rows), T steps, B rows of one agent.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.saying import kind_of
from overcooked_bench.agents.seated import Seated, Views
from overcooked_bench.evaluation.games.streams import stream_key
from overcooked_bench.kitchen.codes import SERVED
from overcooked_bench.kitchen.kitchens import Kitchens, StepResult
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import history_for
from overcooked_bench.kitchen.state import KitchenState

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import Agent


class Games(NamedTuple):
    """N finished episodes.

    Attributes:
        starts: N states.
        actions: (T, N, 2) uint8, joint actions.
        soup_reward: (N, 2) float64, points of each chef.
        partial_reward: (N, 2) float64, points of each chef.
        soups: (N, 2) int64, deliveries of each chef, paid or not.
    """

    starts: list[KitchenState]
    actions: NDArray[np.uint8]
    soup_reward: NDArray[np.float64]
    partial_reward: NDArray[np.float64]
    soups: NDArray[np.int64]


class Episodes(NamedTuple):
    """The returns of the episodes that `play_episodes` played.

    Attributes:
        soup_reward: (episodes,) float64, the team's points, 20 for each soup in the classic kitchens.
        partial_reward: (episodes, 2) float64, each chef's points for useful steps on the way (3 / 3 / 5).
    """

    soup_reward: NDArray[np.float64]
    partial_reward: NDArray[np.float64]


def play_episodes(
    layout: str | Path | Layout,
    agents: "tuple[Agent, Agent]",
    episodes: int = 100,
    seed: int = 0,
    cooking: str = "auto",
    start: str = "random",
    horizon: int = 400,
) -> Episodes:
    """Plays two agents with each other, all episodes in one batch.

    Args:
        layout: A shipped name, a grid's text, a `.layout` file or a Layout.
        agents: agents[k] sits on seat k. Two objects: an agent that meets itself is loaded twice.
        episodes: Number of episodes.
        seed: Episode i depends on (seed, i) alone.
        cooking: "auto" or "manual".
        start: "random" or "standard".
        horizon: Steps of an episode.

    Raises:
        ValueError: The same object twice, or an argument that `Kitchens` refuses.
        SeatedFault: An agent raised, or answered with something other than one action per row.
        UnknownLayout: An agent cannot play this layout.

    Example:
        ```python
        from overcooked_bench import load_agent, play_episodes

        pair = load_agent("greedy", "cramped_room"), load_agent("random", "cramped_room")
        print(play_episodes("cramped_room", agents=pair, episodes=20).soup_reward.mean())
        ```
    """
    first, second = agents
    if first is second:
        raise ValueError("agents holds the same object twice, which would mix up two games; load the agent twice")
    parties = [
        Seated(agent, f"agent {seat} ({kind_of(agent)})", np.arange(episodes), np.full(episodes, seat))
        for seat, agent in enumerate((first, second))
    ]
    kitchens = make_kitchens(layout, episodes, parties, cooking=cooking, start=start, horizon=horizon)
    kitchens.reset(seed=seed)
    seeds = np.array([[stream_key("episode", seed, i, k) for k in range(2)] for i in range(episodes)], np.uint64)
    games = play(kitchens, parties, seeds)
    return Episodes(games.soup_reward.sum(axis=1), games.partial_reward)


def make_kitchens(layout: str | Path | Layout, rows: int, parties: Sequence[Seated], **settings: Any) -> Kitchens:
    """Makes the kitchens that `play` needs for these agents, with the past that one of them may look back at."""
    history = history_for(party.observation for party in parties)
    return Kitchens(layout, rows, history=history, actions_taken=True, autoreset=False, **settings)


def play(
    kitchens: Kitchens,
    parties: Sequence[Seated],
    seeds: NDArray[np.uint64],
    watch: Callable[[Kitchens, StepResult], object] | None = None,
) -> Games:
    """Plays one episode in every kitchen, from the states that they are in, to the horizon.

    Args:
        kitchens: Of `make_kitchens`, just reset; over afterwards.
        parties: Together they sit on every seat of every kitchen once.
        seeds: (N, 2) uint64, the random stream of the agent on each seat.
        watch: Called after each step with the kitchens, as they are then, and what the step brought.

    Raises:
        SeatedFault: An agent raised, answered with something other than one action per row, or asks for an observation
            that this kitchen does not have.
        UnknownLayout: An agent cannot play this layout.
    """
    n, horizon = kitchens.num_kitchens, kitchens.horizon
    for party in parties:
        party.reset(kitchens.layout.name, seeds[party.rows, party.seats])
        party.fit(kitchens)
    starts = [kitchens.state(i) for i in range(n)]
    views = Views(kitchens)
    actions, joint = np.empty((horizon, n, 2), np.uint8), np.empty((n, 2), np.int64)
    soup_reward, partial_reward, soups = np.zeros((n, 2)), np.zeros((n, 2)), np.zeros((n, 2), np.int64)
    for step in range(horizon):
        views.renew()
        for party in parties:
            joint[party.rows, party.seats] = party.act(views.of(party))
        actions[step] = joint
        result = kitchens.step(joint)
        soup_reward += result.soup_reward
        partial_reward += result.partial_reward
        assert result.actions_taken is not None
        soups += result.actions_taken & SERVED != 0
        if watch:
            watch(kitchens, result)
    return Games(starts, actions, soup_reward, partial_reward, soups)
