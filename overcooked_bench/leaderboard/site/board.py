"""`Board`: the entries of one protocol and pool in one table, best first, with the groups that the data separate."""

from collections.abc import Sequence
from itertools import combinations
from typing import Final, NamedTuple

from overcooked_bench.evaluation.comparing.letters import letters_of
from overcooked_bench.evaluation.comparing.permutation import holm, over_seeds, smallest_p
from overcooked_bench.evaluation.protocol import NEWEST, load_protocol
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.leaderboard.site.entries import Entry

TABLES: Final = {
    "main": "Ranked",
    "open": "Open: trained or selected with the pool that scores it",
    "unranked": "Not ranked: reported only, withdrawn, or of a protocol that ranks nothing",
}
LEVEL: Final = 0.05
"""Two methods are separated if their adjusted p is this or less."""


class Board(NamedTuple):
    """A table.

    Attributes:
        table: Which of `TABLES`.
        entries: Its rows, the highest score first.
        groups: Key -> letters; two methods that share one are not separated. Only methods have some.
    """

    table: str
    entries: tuple[Entry, ...]
    groups: dict[str, str]


class Games(NamedTuple):
    """The entries that played the same protocol and pool; scores of two are never shown in one table.

    Attributes:
        scores: One of theirs.
        current: Whether this is the newest protocol.
        boards: Its tables, without empty ones.
    """

    scores: Scores
    current: bool
    boards: tuple[Board, ...]

    @property
    def title(self) -> str:
        """What it is called."""
        pool = f", pool {self.scores.pool.name}" if self.scores.pool else ""
        return f"Protocol {self.scores.protocol.name}{pool} ({self.mark})"

    @property
    def mark(self) -> str:
        """The beginnings of the hashes of protocol and pool."""
        pool = self.scores.pool
        return self.scores.protocol.sha256[:8] + (f"-{pool.sha256[:8]}" if pool else "")


def games_of(entries: Sequence[Entry]) -> list[Games]:
    """Sorts entries into tables; the newest protocol first, the others by name."""
    newest = load_protocol(NEWEST)
    apart: dict[tuple[str, str], list[Entry]] = {}
    for entry in entries:
        pool = entry.scores.pool
        apart.setdefault((entry.scores.protocol.sha256, pool.sha256 if pool else ""), []).append(entry)
    found = []
    for (protocol, pool_hash), some in apart.items():
        current = protocol == newest.sha256 and pool_hash == newest.play.pool_sha256
        boards = [_board(name, [one for one in some if one.table == name]) for name in TABLES]
        found.append(Games(some[0].scores, current, tuple(board for board in boards if board.entries)))
    return sorted(found, key=lambda one: (not one.current, one.scores.protocol.name, one.mark))


def _board(table: str, entries: Sequence[Entry]) -> Board:
    order = sorted(entries, key=lambda one: (-one.scores.overall.value if one.scores.overall else 1e9, one.key))
    return Board(table, tuple(order), {} if table == "unranked" else separated(order))


def separated(entries: Sequence[Entry]) -> dict[str, str]:
    """Returns the letters of the methods among entries of the same protocol.

    Every two of the same seed and salt are tested over training seeds, adjusted by Holm. If there are so many that no
    pair could be separated, none is tested.

    Args:
        entries: The highest score first.
    """
    runs = {one.key: _runs(one) for one in entries if one.scores.kind == "method" and _runs(one)}
    games = {one.key: (one.scores.seed, one.scores.salt) for one in entries}
    names = list(runs)
    pairs = [pair for pair in combinations(names, 2) if games[pair[0]] == games[pair[1]]]
    most = max(map(len, runs.values()), default=0)
    apart: set[frozenset[str]] = set()
    if pairs and smallest_p(most) * len(pairs) <= LEVEL:
        p = []
        for one, other in pairs:
            seeds = min(len(runs[one]), len(runs[other]))
            p.append(over_seeds(runs[one][:seeds], runs[other][:seeds]))
        apart = {frozenset(pair) for pair, adjusted in zip(pairs, holm(p), strict=True) if adjusted <= LEVEL}
    return letters_of(names, apart)


def _runs(entry: Entry) -> tuple[float, ...]:
    """Returns the score of each training seed over all layouts; none if it has no overall score."""
    row = entry.scores.find(entry.scores.headline)
    found = row.per_repetition or () if row is not None else ()
    return found if len(found) == entry.scores.training_seeds else ()
