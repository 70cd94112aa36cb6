"""The ledger of a pool's build: what pairs of players reached with each other, so that none is played twice."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Final

import msgspec
import numpy as np

from overcooked_bench.documents import read_json
from overcooked_bench.evaluation.pools.meeting import PURPOSE, play_pairs
from overcooked_bench.evaluation.pools.pairs import Played
from overcooked_bench.evaluation.pools.players import Player
from overcooked_bench.files import write_whole

from .build import PoolBuildError

_MOST_BYTES: Final = 1 << 30
_CHUNK: Final = 32_768
"""Episodes between two times that the file is written."""


class _Pair(msgspec.Struct):
    """The (episode, seat) of a pair in row-major order: points, and the side of the agent."""

    returns: list[float]
    sides: list[int]


class Ledger:
    """Pairs that were played on a layout, in a file.

    What is asked for is looked up by the hashes of both players, the purpose, the seed and the episodes. What is
    missing is played in portions whose bounds do not depend on what is known, so that an interrupted build and one
    that was not find the same numbers.

    Args:
        file: Its file; may be missing.
    """

    def __init__(self, file: Path) -> None:
        self._file = file
        self._known: dict[str, _Pair] = {}
        if file.is_file():
            try:
                self._known = read_json(file, _MOST_BYTES, dict[str, _Pair], PoolBuildError)
            except PoolBuildError as error:
                raise PoolBuildError(f"{error}; remove the file, and it is measured again") from None

    def play(
        self,
        layout: str,
        players: Sequence[Player],
        pairs: Sequence[tuple[int, int]],
        episodes: int,
        seed: int = 0,
        workers: int = 1,
        horizon: int = 400,
        on_progress: Callable[[int, int], object] = lambda done, of: None,
        purpose: str = PURPOSE,
        engine: str = "local",
    ) -> Played:
        """Plays those of some pairs that are not in the ledger, as `play_pairs` does, and returns all.

        Raises:
            WrongUse, PoolError: As `play_pairs`.
        """
        what = f"{purpose}/{seed}/{horizon}/{episodes}"
        keys = [f"{what}/{players[agent].sha256}/{players[partner].sha256}" for agent, partner in pairs]
        size = max(1, _CHUNK // (2 * episodes))
        for first in range(0, len(pairs), size):
            end = min(first + size, len(pairs))
            missing = [i for i in range(first, end) if keys[i] not in self._known]
            if not missing:
                continue
            wanted = [pairs[i] for i in missing]
            where = episodes, seed, workers, horizon
            played = play_pairs(layout, players, wanted, *where, purpose=purpose, engine=engine)
            for i, returns, sides in zip(missing, *played, strict=True):
                self._known[keys[i]] = _Pair(returns.ravel().tolist(), sides.ravel().tolist())
            self._file.parent.mkdir(parents=True, exist_ok=True)
            write_whole(self._file, msgspec.json.encode(self._known))
            on_progress(end, len(pairs))
        found = [self._known[key] for key in keys]
        shape = len(pairs), episodes, 2
        return Played(
            np.array([one.returns for one in found], np.float64).reshape(shape),
            np.array([one.sides for one in found], np.int64).reshape(shape),
        )
