"""`Board`: the entries of one protocol and pool in one table, best first, with what the data separate."""

from collections.abc import Sequence
from typing import Final, NamedTuple

from overcooked_bench.evaluation.pools.normalised import partner_shares
from overcooked_bench.evaluation.protocol import NEWEST, load_protocol
from overcooked_bench.evaluation.scores import Scores
from overcooked_bench.leaderboard.site.entries import Entry
from overcooked_bench.leaderboard.site.groups import Groups, separate, separate_agents

TABLES: Final = {
    "main": "Methods",
    "agents": "Single agents",
    "open": "Open: trained or selected with the pool that scores it",
    "unranked": "Not ranked",
}
"""Tables in their order, and their titles."""


_ROUNDING: Final = 1e-6


class Board(NamedTuple):
    """A table.

    Attributes:
        table: Which of `TABLES`.
        entries: Its rows, the highest score first.
        groups: What the data separate among its methods, or among its agents in their own table, by key.
    """

    table: str
    entries: tuple[Entry, ...]
    groups: Groups


class Games(NamedTuple):
    """The entries that played the same protocol and pool; scores of two are never shown in one table.

    Attributes:
        scores: One of theirs, of a shipped entry if there is one.
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
        """The beginnings of the hashes of protocol and pool, which name its pages."""
        pool = self.scores.pool
        return self.scores.protocol.sha256[:8] + (f"-{pool.sha256[:8]}" if pool else "")

    @property
    def page(self) -> str:
        """The address of its page, from the index."""
        return f"protocols/{self.mark}.html"

    @property
    def curves(self) -> str:
        """The address of the page of its ordered curves, from the index."""
        return f"curves/{self.mark}.html"

    @property
    def entries(self) -> list[Entry]:
        """All its entries, table by table."""
        return [entry for board in self.boards for entry in board.entries]


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
        shown = next((one.scores for one in some if one.shipped), some[0].scores)
        found.append(Games(shown, current, tuple(board for board in boards if board.entries)))
    return sorted(found, key=lambda one: (not one.current, one.scores.protocol.name, one.mark))


def _board(table: str, entries: Sequence[Entry]) -> Board:
    order = sorted(entries, key=lambda one: (-one.scores.overall.value if one.scores.overall else 1e9, one.key))
    if table == "agents":
        return Board(table, tuple(order), separate_agents({one.key: one.parts for one in order if one.parts}))
    methods = [] if table == "unranked" else [one for one in order if one.scores.kind == "method"]
    return Board(table, tuple(order), separate({one.key: runs for one in methods if (runs := runs_of(one))}))


def runs_of(entry: Entry, layout: str | None = None) -> tuple[float, ...]:
    """Returns the score of each training seed, over all layouts or on one; none if it has no such score."""
    row = entry.scores.find(entry.scores.headline, layout=layout)
    found = row.per_repetition or () if row is not None else ()
    return found if len(found) == entry.scores.training_seeds else ()


def parts_of(scores: Scores) -> dict[tuple[str, str], float]:
    """Returns what each partner adds to the score of a single agent, by layout and name; they sum to it.

    Empty for a method, and if the score does not hold single partners, or not as shares of the whole.

    Raises:
        WrongUse: Some partners of a stratum have a weight and others have none.
    """
    if scores.kind != "agent" or scores.overall is None:
        return {}
    found = {}
    for layout in scores.layouts:
        labels = [label for label in layout.partners if label.counts]
        for label, share in zip(labels, partner_shares(labels) / len(scores.layouts), strict=True):
            row = scores.find(scores.headline, layout=layout.layout, partner=label.name)
            if row is None:
                return {}
            found[layout.layout, label.name] = float(share * row.value)
    return found if abs(sum(found.values()) - scores.overall.value) < _ROUNDING else {}
