"""Plays episodes in one batch: every agent sees its own seats alone, and every joint action is kept.

Axes: N kitchens (rows), T steps, B rows of one agent.
"""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.agents.agent import GameError, UnknownLayout
from overcooked_bench.agents.submissions.checks import AgentError, check_actions
from overcooked_bench.agents.watch import LOADING, calling
from overcooked_bench.errors import AgentFault
from overcooked_bench.evaluation.games.streams import stream_key
from overcooked_bench.kitchen.codes import NUM_ACTIONS
from overcooked_bench.kitchen.kitchens import Kitchens, StepResult
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.observations.registry import history_for
from overcooked_bench.kitchen.state import KitchenState

if TYPE_CHECKING:
    from overcooked_bench.agents.agent import Agent

STATE = "state"
"""The observation that is a list of KitchenState."""


class PlayFault(AgentFault):
    """An agent broke the contract while playing.

    Attributes:
        party: Index of the agent's `Party`.
        step: Steps played before; None at the reset.
        row: Index into the party's rows where one row is to blame, else None.
    """

    def __init__(self, message: str, party: int, step: int | None, row: int | None = None) -> None:
        super().__init__(message)
        self.party, self.step, self.row = party, step, row

    def __reduce__(self) -> tuple[type["PlayFault"], tuple[object, ...]]:
        """Lets it travel from a worker process whole."""
        return PlayFault, (str(self), self.party, self.step, self.row)


class Party(NamedTuple):
    """One agent and the seats that it sits on.

    Attributes:
        agent: The agent.
        rows: (B,) int64, kitchens.
        seats: (B,) int64, its seat in each.
    """

    agent: "Agent"
    rows: NDArray[np.int64]
    seats: NDArray[np.int64]


class Games(NamedTuple):
    """N finished episodes.

    Attributes:
        starts: N states.
        actions: (T, N, 2) uint8, joint actions.
        soup_reward: (N, 2) float64, points of each chef.
        partial_reward: (N, 2) float64, points of each chef.
        soups: (N, 2) int64, paid deliveries of each chef.
    """

    starts: list[KitchenState]
    actions: NDArray[np.uint8]
    soup_reward: NDArray[np.float64]
    partial_reward: NDArray[np.float64]
    soups: NDArray[np.int64]


class Episodes(NamedTuple):
    """What `play_episodes` gives.

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
        episodes: How many.
        seed: Episode i depends on (seed, i) alone.
        cooking: "auto" or "manual".
        start: "random" or "standard".
        horizon: Steps of an episode.

    Raises:
        ValueError: The same object twice, or an argument that `Kitchens` refuses.
        PlayFault: An agent raised, or answered with something other than one action a row.
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
    parties = [Party(agent, np.arange(episodes), np.full(episodes, seat)) for seat, agent in enumerate((first, second))]
    kitchens = make_kitchens(layout, episodes, parties, cooking=cooking, start=start, horizon=horizon)
    kitchens.reset(seed=seed)
    seeds = np.array([[stream_key("episode", seed, i, k) for k in range(2)] for i in range(episodes)], np.uint64)
    games = play(kitchens, parties, seeds)
    return Episodes(games.soup_reward.sum(axis=1), games.partial_reward)


def make_kitchens(layout: str | Path | Layout, rows: int, parties: Sequence[Party], **settings: Any) -> Kitchens:
    """Makes kitchens for these agents: with a memory where one of them looks back."""
    return Kitchens(layout, rows, history=history_for(party.agent.observation for party in parties), **settings)


def play(
    kitchens: Kitchens,
    parties: Sequence[Party],
    seeds: NDArray[np.uint64],
    watch: Callable[[Kitchens, StepResult], object] | None = None,
) -> Games:
    """Plays one episode in every kitchen, from the states that they are in, to the horizon.

    Args:
        kitchens: Just reset; over afterwards.
        parties: Together they sit on every seat of every kitchen once.
        seeds: (N, 2) uint64, the random stream of the agent on each seat.
        watch: Called after each step with the kitchens, as they are then, and what the step brought.

    Raises:
        PlayFault: An agent raised, answered with something other than one action a row, or asks for an observation
            that this kitchen does not have.
        UnknownLayout: An agent cannot play this layout.
    """
    n, horizon = kitchens.num_kitchens, kitchens.horizon
    kitchens.autoreset = False
    for index, (agent, rows, seats) in enumerate(parties):
        try:
            with calling("reset", LOADING):
                agent.reset(kitchens.layout.name, seats.copy(), seeds[rows, seats])
        except UnknownLayout:
            raise
        except (Exception, SystemExit) as error:
            raise PlayFault(_told("reset", error), index, None, _row_named(error, len(rows))) from error
        if agent.observation != STATE:
            try:
                kitchens.observation_shape(agent.observation)
            except ValueError as error:
                raise PlayFault(f"its observation cannot be given here: {error}", index, None) from error
    starts = [kitchens.state(i) for i in range(n)]
    views = {name: kitchens.observe(name) for name in sorted({p.agent.observation for p in parties} - {STATE})}
    observes_states = any(party.agent.observation == STATE for party in parties)
    actions, joint = np.empty((horizon, n, 2), np.uint8), np.empty((n, 2), np.int64)
    soup_reward, partial_reward, soups = np.zeros((n, 2)), np.zeros((n, 2)), np.zeros((n, 2), np.int64)
    for step in range(horizon):
        for name, view in views.items():
            kitchens.observe(name, out=view)
        states = [kitchens.state(i) for i in range(n)] if observes_states else starts
        for index, (agent, rows, seats) in enumerate(parties):
            name = agent.observation
            seen = [states[row] for row in rows] if name == STATE else views[name][rows, seats]
            try:
                with calling(f"act, step {step}"):
                    answer = agent.act(seen)
            except (Exception, SystemExit) as error:
                raise PlayFault(_told("act", error), index, step, _row_named(error, len(rows))) from error
            joint[rows, seats] = _checked(answer, len(rows), index, step)
        actions[step] = joint
        result = kitchens.step(joint)
        soup_reward += result.soup_reward
        partial_reward += result.partial_reward
        soups += result.soup_reward > 0
        if watch:
            watch(kitchens, result)
    return Games(starts, actions, soup_reward, partial_reward, soups)


def _checked(answer: Any, rows: int, party: int, step: int) -> NDArray[np.int64]:
    """Gives an agent's answer as (rows,) int64; the usual answer costs one look."""
    if (
        isinstance(answer, np.ndarray)
        and answer.dtype == np.int64
        and answer.shape == (rows,)
        and answer.min() >= 0
        and answer.max() < NUM_ACTIONS
    ):
        return answer
    try:
        return check_actions(answer, rows, "its answer")
    except AgentError as error:
        raise PlayFault(str(error).removeprefix("its answer: "), party, step, _row_at_fault(answer, rows)) from None


def _row_at_fault(answer: Any, rows: int) -> int | None:
    """Gives the first row whose whole number is no action; None where something else is wrong with the answer."""
    try:
        given = np.asarray(answer.detach().cpu() if hasattr(answer, "detach") else answer)
    except (ValueError, TypeError):
        return None
    if given.shape != (rows,) or given.dtype.kind not in "iu":
        return None
    return int(np.argmax((given < 0) | (given >= NUM_ACTIONS)))


def _row_named(error: BaseException, rows: int) -> int | None:
    """Gives the row that an adapter of single games blames; None where nobody knows."""
    return error.row if isinstance(error, GameError) and 0 <= error.row < rows else None


def _told(method: str, error: BaseException) -> str:
    if isinstance(error, GameError):
        return str(error)
    return f"{method}() raised {type(error).__name__}" + (f": {error}" if str(error) else "")
