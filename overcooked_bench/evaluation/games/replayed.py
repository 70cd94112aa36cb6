"""Plays stored episodes again from their start states and joint actions, and compares their returns.

Axes: N episodes of one layout, T steps.
"""

from collections.abc import Iterable, Iterator
from itertools import groupby, islice
from typing import Any, Final

import msgspec
import numpy as np

from overcooked_bench.evaluation.games.episode import Episode
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.protocol import Protocol, upgrade
from overcooked_bench.kitchen.codes import SERVED
from overcooked_bench.kitchen.kitchens import Kitchens

_MOST_ROWS: Final = 2048


def read_settings(store: Store) -> Protocol:
    """Reads the protocol that a store was played under.

    Raises:
        StoreError: It is missing or damaged.
    """
    try:
        settings = msgspec.json.decode(store.facts.get("settings", ""), type=dict[str, Any])
        return msgspec.convert(upgrade(settings), Protocol)
    except (ValueError, RecursionError) as error:
        raise StoreError(f"{store.file}: the protocol that it was played under cannot be read ({error})") from error


def check_returns(store: Store, cooking: str, horizon: int) -> int:
    """Replays every stored episode, all of a layout at once.

    Args:
        store: Where the episodes are.
        cooking: The protocol's cooking mode.
        horizon: T, the protocol's number of steps.

    Returns:
        How many episodes were replayed.

    Raises:
        StoreError: A block is not as it was written, or an episode's joint actions do not bring the points or soups
            that are stored; names the file and the cell.
    """
    count = 0
    for layout, episodes in groupby(store.episodes(), key=lambda episode: episode.layout):
        for some in _chunks(episodes):
            _check(store, layout, some, cooking, horizon)
            count += len(some)
    return count


def _chunks(episodes: Iterable[Episode]) -> Iterator[list[Episode]]:
    iterator = iter(episodes)
    while some := list(islice(iterator, _MOST_ROWS)):
        yield some


def _check(store: Store, layout: str, episodes: list[Episode], cooking: str, horizon: int) -> None:
    n = len(episodes)
    try:
        kitchens = Kitchens(layout, n, cooking=cooking, horizon=horizon, actions_taken=True, autoreset=False)
    except ValueError as error:
        raise StoreError(f"{store.file}: the episodes on {layout!r} cannot be replayed: {error}") from error
    joint = np.empty((horizon, n, 2), np.int64)
    for row, episode in enumerate(episodes):
        try:
            state = episode.first_state
            if state.timestep:
                raise ValueError(f"the first state is that of step {state.timestep}")
            kitchens.set_state(row, state)
            joint[:, row] = episode.joint_actions(horizon)
            if joint[:, row].max() > 5:
                raise ValueError("a joint action is none of 0 to 5")
        except (ValueError, OverflowError, RecursionError, LookupError) as error:
            raise StoreError(f"{store.file}: {episode.cell} cannot be replayed: {error}") from error
    brought = np.zeros((4, n, 2))  # points, partial rewards, soups served and soups paid for, of each chef
    for step in range(horizon):
        result = kitchens.step(joint[step])
        assert result.actions_taken is not None
        served = result.actions_taken & SERVED != 0
        brought += result.soup_reward, result.partial_reward, served, result.soup_reward > 0
    rows, seats = np.arange(n), np.array([episode.seat for episode in episodes])
    mine, theirs = brought[:, rows, seats].T.tolist(), brought[:, rows, 1 - seats].T.tolist()
    for episode, points, own, other in zip(episodes, brought[0].sum(axis=1).tolist(), mine, theirs, strict=True):
        for column, value, replayed, instead in (
            ("soup_reward", episode.soup_reward, points, points),
            ("ego_partial_reward", episode.ego_partial_reward, own[1], own[1]),
            ("partner_partial_reward", episode.partner_partial_reward, other[1], other[1]),
            ("ego_soups", episode.ego_soups, own[2], own[3]),  # schema 1 counted soups that were paid for
            ("partner_soups", episode.partner_soups, other[2], other[3]),
        ):
            if value not in (replayed, instead):
                raise StoreError(
                    f"{store.file}: {episode.cell}: {column} is {value:g}, but its joint actions bring {replayed:g}; "
                    "the file was changed, or written by a version with other rules. Delete it, or write to another "
                    "folder with --output"
                )
