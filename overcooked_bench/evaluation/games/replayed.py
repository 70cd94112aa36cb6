"""Plays stored episodes again from their start states and joint actions, and compares what they bring.

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
        kitchens = Kitchens(layout, n, cooking=cooking, horizon=horizon)
    except ValueError as error:
        raise StoreError(f"{store.file}: the episodes on {layout!r} cannot be replayed: {error}") from error
    kitchens.autoreset = False
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
    brought = np.zeros((3, n, 2))  # points, partial rewards, soups of each chef
    for step in range(horizon):
        result = kitchens.step(joint[step])
        brought += result.soup_reward, result.partial_reward, result.soup_reward > 0
    seats = np.array([episode.seat for episode in episodes])
    rows = np.arange(n)
    mine, theirs = brought[:, rows, seats], brought[:, rows, 1 - seats]
    found = np.stack([brought[0].sum(axis=1), mine[1], theirs[1], mine[2], theirs[2]], axis=1)
    for episode, row in zip(episodes, found.tolist(), strict=True):
        stored = {
            "soup_reward": episode.soup_reward,
            "ego_partial_reward": episode.ego_partial_reward,
            "partner_partial_reward": episode.partner_partial_reward,
            "ego_soups": episode.ego_soups,
            "partner_soups": episode.partner_soups,
        }
        for (column, value), replayed in zip(stored.items(), row, strict=True):
            if value != replayed:
                raise StoreError(
                    f"{store.file}: {episode.cell}: {column} is {value:g}, but its joint actions bring {replayed:g}; "
                    "the file was changed, or written by a version with other rules. Delete it, or write to another "
                    "folder with --output"
                )
