"""Keeps what was played, so that each pair of agents plays once and results are summed up again in seconds.

Axes: N pairs, E episodes from each seat, K = 2 seats of the pair's agent.
"""

import sys
from collections.abc import Sequence
from io import BytesIO
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.evaluation.pools.meeting import play_pairs
from overcooked_bench.evaluation.pools.pairs import Played
from overcooked_bench.evaluation.pools.players import Player
from overcooked_bench.files import write_whole


class PlayedPairs:
    """Plays pairs of agents that were not played before, and remembers all of them.

    A pair is known by the hashes of its agent and of its partner.

    Args:
        folder: Where; holds a file for each layout, number of episodes, seed and horizon.
        episodes: E.
        seed: Of all streams.
        horizon: Steps of an episode.
        workers: Processes.
    """

    def __init__(self, folder: Path, episodes: int, seed: int = 0, horizon: int = 400, workers: int = 1) -> None:
        self.episodes = episodes
        self._folder, self._seed, self._horizon, self._workers = folder, seed, horizon, workers
        self._known: dict[str, dict[str, tuple[NDArray[np.float64], NDArray[np.int64]]]] = {}

    def pairs(self, layout: str, pairs: Sequence[tuple[Player, Player]]) -> Played:
        """Returns the episodes of some pairs of an agent and a partner, played now where that is needed.

        Args:
            layout: Where.
            pairs: N of them.

        Returns:
            (N, E, K) returns and sides.
        """
        known = self._read(layout)
        missing = {_key(*pair): pair for pair in pairs if _key(*pair) not in known}
        if missing:
            self._play(layout, missing)
        found = [known[_key(*pair)] for pair in pairs]
        shape = len(pairs), self.episodes, 2
        returns, sides = (np.array([one[part] for one in found]).reshape(shape) for part in (0, 1))
        return Played(returns, sides.astype(np.int64))

    def matrix(self, layout: str, agents: Sequence[Player], partners: Sequence[Player]) -> Played:
        """Returns the episodes of every agent with every partner: (A, P, E, K) returns and sides."""
        played = self.pairs(layout, [(agent, partner) for agent in agents for partner in partners])
        shape = len(agents), len(partners), self.episodes, 2
        return Played(played.returns.reshape(shape), played.sides.reshape(shape))

    def _play(self, layout: str, missing: dict[str, tuple[Player, Player]]) -> None:
        players: dict[str, Player] = {}
        for pair in missing.values():
            for player in pair:
                players.setdefault(player.sha256, player)
        place = {sha256: index for index, sha256 in enumerate(players)}
        order = sorted(missing, key=lambda key: (missing[key][1].sha256, missing[key][0].sha256))
        indices = [(place[agent.sha256], place[partner.sha256]) for agent, partner in (missing[key] for key in order)]
        print(f"{layout}: {len(order)} pairs, {2 * self.episodes} episodes each", file=sys.stderr, flush=True)
        returns, sides = play_pairs(
            layout, [*players.values()], indices, self.episodes, self._seed, self._workers, self._horizon
        )
        known = self._read(layout)
        known.update({key: (returns[row], sides[row]) for row, key in enumerate(order)})
        written = BytesIO()
        keys, values = [*known], [*known.values()]
        np.savez_compressed(
            written,
            pairs=np.array(keys),
            returns=np.array([r for r, _ in values]),
            sides=np.array([s for _, s in values]),
        )
        self._folder.mkdir(parents=True, exist_ok=True)
        write_whole(self._file(layout), written.getvalue())

    def _read(self, layout: str) -> dict[str, tuple[NDArray[np.float64], NDArray[np.int64]]]:
        if layout not in self._known:
            self._known[layout] = {}
            if self._file(layout).exists():
                with np.load(self._file(layout), allow_pickle=False) as kept:
                    rows = zip(kept["pairs"].tolist(), kept["returns"], kept["sides"], strict=True)
                    self._known[layout] = {key: (returns, sides) for key, returns, sides in rows}
        return self._known[layout]

    def _file(self, layout: str) -> Path:
        return self._folder / f"{layout}-{self.episodes}-episodes-seed-{self._seed}-horizon-{self._horizon}.npz"


def _key(agent: Player, partner: Player) -> str:
    return f"{agent.sha256} {partner.sha256}"
