"""The store of a score: every episode of every finished block, in SQLite.

A block is written in one transaction, so that a process may be killed at any moment and the next one goes on.
"""

import json
import sqlite3
import zlib
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Final, NamedTuple

import numpy as np
from numpy.typing import NDArray

from overcooked_bench.errors import WrongUse
from overcooked_bench.kitchen.state import KitchenState

SCHEMA: Final = "1"
_TABLES: Final = """
CREATE TABLE facts (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE blocks (
    layout TEXT, training_seed INTEGER, episode INTEGER, adapted INTEGER NOT NULL,
    PRIMARY KEY (layout, training_seed, episode)
) WITHOUT ROWID;
CREATE TABLE episodes (
    layout TEXT, training_seed INTEGER, episode INTEGER, partner TEXT, seat INTEGER,
    partner_sha256 TEXT NOT NULL, kind TEXT NOT NULL,
    soup_reward REAL NOT NULL,
    ego_partial_reward REAL NOT NULL, partner_partial_reward REAL NOT NULL,
    ego_soups INTEGER NOT NULL, partner_soups INTEGER NOT NULL,
    start TEXT NOT NULL, actions BLOB NOT NULL,
    PRIMARY KEY (layout, training_seed, episode, partner, seat)
);
"""
_COLUMNS: Final = 14
_KEY: Final = "layout, training_seed, episode, partner, seat"


class StoreError(WrongUse):
    """A score's folder cannot be used; the message says why and what to do instead."""


class Episode(NamedTuple):
    """One finished episode; a row of the table `episodes`.

    Attributes:
        layout: The layout's name.
        training_seed: Which training run of the scored agent.
        episode: Index of the start state.
        partner: The partner's name.
        seat: The scored agent's seat.
        partner_sha256: Hash of what the partner is.
        kind: "trained", "scripted" or "floor".
        soup_reward: The team's points.
        ego_partial_reward: The scored agent's partial rewards, points.
        partner_partial_reward: The partner's.
        ego_soups: Soups that the scored agent delivered.
        partner_soups: Soups that the partner delivered.
        start: The first state in overcooked_ai's JSON form.
        actions: (T, 2) uint8 joint actions, packed by `pack_actions`.
    """

    layout: str
    training_seed: int
    episode: int
    partner: str
    seat: int
    partner_sha256: str
    kind: str
    soup_reward: float
    ego_partial_reward: float
    partner_partial_reward: float
    ego_soups: int
    partner_soups: int
    start: str
    actions: bytes

    @property
    def first_state(self) -> KitchenState:
        """The state that the episode began in."""
        return KitchenState.from_dict(json.loads(self.start))

    @property
    def joint_actions(self) -> NDArray[np.uint8]:
        """(T, 2) uint8."""
        return np.frombuffer(zlib.decompress(self.actions), np.uint8).reshape(-1, 2)


def pack_state(state: KitchenState) -> str:
    """Writes a state as compact JSON."""
    return json.dumps(state.to_dict(), separators=(",", ":"))


def pack_actions(actions: NDArray[np.uint8]) -> bytes:
    """Compresses (T, 2) joint actions."""
    return zlib.compress(np.ascontiguousarray(actions).tobytes(), 6)


class Store:
    """The episodes of one score.

    Args:
        file: The database; made where there is none.
        facts: What identifies the score (hashes of protocol, agent and pool); those of an existing store must be the
            same once it holds a finished block, and are replaced before. None opens an existing store as it is.
        notes: What else is to be kept; not compared.

    Attributes:
        facts: Facts and notes of the store.

    Raises:
        StoreError: The file belongs to another score, to another version, or is not a store.
    """

    def __init__(
        self, file: str | Path, facts: Mapping[str, str] | None = None, notes: Mapping[str, str] | None = None
    ) -> None:
        self.file = Path(file)
        if facts is None and not self.file.is_file():
            raise StoreError(f"{self.file}: no such file; give the folder of a score, or its episodes.sqlite")
        self.file.parent.mkdir(parents=True, exist_ok=True)
        self._connection = sqlite3.connect(self.file, isolation_level=None, timeout=60)
        try:
            with self._transaction():
                if facts is not None:
                    self._begin({**(notes or {}), **facts, "schema": SCHEMA})
            self.facts: dict[str, str] = self._read_facts()
        except sqlite3.DatabaseError as error:
            self.close()
            raise StoreError(f"{self.file}: not a store of episodes ({error}); choose another folder") from error
        try:
            self._compare({**(facts or {}), "schema": SCHEMA})
        except StoreError:
            self.close()
            raise

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the file."""
        self._connection.close()

    def blocks(self) -> set[tuple[str, int, int]]:
        """Lists the finished blocks: (layout, training seed, episode)."""
        return set(self._connection.execute("SELECT layout, training_seed, episode FROM blocks"))

    def adapted(self) -> set[str]:
        """Lists the layouts that were played in their mirror image."""
        return {layout for (layout,) in self._connection.execute("SELECT layout FROM blocks WHERE adapted")}

    def add_block(self, block: tuple[str, int, int], episodes: Iterable[Episode], adapted: bool = False) -> None:
        """Writes a finished block at once; a block that is there already is left alone.

        Raises:
            StoreError: Another score has taken the store over since it was opened.
        """
        marks = ", ".join("?" * _COLUMNS)
        with self._transaction():
            if self._read_facts() != self.facts:
                raise StoreError(f"{self.file} was taken over by another score; give each its own folder with --output")
            written = self._connection.execute(
                "INSERT OR IGNORE INTO blocks VALUES (?, ?, ?, ?)", (*block, int(adapted))
            )
            if written.rowcount:
                self._connection.executemany(f"INSERT INTO episodes VALUES ({marks})", episodes)

    def find(self, where: Mapping[str, str | int], worst: bool = False) -> Episode | None:
        """Reads the first episode that fits, in the order of its key; None where none does.

        Args:
            where: Column of `Episode` -> value.
            worst: Floors left out, the one with the fewest points.
        """
        conditions = [f"{_column(column)} = ?" for column in where] + (["kind != 'floor'"] if worst else [])
        order = ("soup_reward, " if worst else "") + _KEY
        query = f"SELECT * FROM episodes WHERE {' AND '.join(conditions) or '1'} ORDER BY {order} LIMIT 1"
        row = self._connection.execute(query, tuple(where.values())).fetchone()
        return row and Episode(*row)

    def values(self, column: str) -> list[Any]:
        """Lists what stands in a column of `Episode`, each value once."""
        name = _column(column)
        return [value for (value,) in self._connection.execute(f"SELECT DISTINCT {name} FROM episodes ORDER BY {name}")]

    def episodes(self) -> Iterator[Episode]:
        """Reads all episodes in the order of their key."""
        for row in self._connection.execute(f"SELECT * FROM episodes ORDER BY {_KEY}"):
            yield Episode(*row)

    def returns(self) -> list[tuple[Any, ...]]:
        """Reads what scores are made of, without starts and actions: all columns of `Episode` up to `partner_soups`."""
        columns = ", ".join(Episode._fields[:-2])
        return list(self._connection.execute(f"SELECT {columns} FROM episodes ORDER BY {_KEY}"))

    def _begin(self, entries: Mapping[str, str]) -> None:
        """Writes what identifies the score, unless a finished block belongs to what is written there already."""
        if not self._has_tables():
            for statement in _TABLES.split(";"):
                self._connection.execute(statement)
        elif self._read_facts().get("schema") != SCHEMA or self.blocks():
            return
        self._connection.execute("DELETE FROM facts")
        self._connection.executemany("INSERT INTO facts VALUES (?, ?)", sorted(entries.items()))

    def _read_facts(self) -> dict[str, str]:
        return dict(self._connection.execute("SELECT key, value FROM facts"))

    def _has_tables(self) -> bool:
        found = self._connection.execute("SELECT count(*) FROM sqlite_master WHERE name = 'facts'")
        return bool(found.fetchone()[0])

    def _compare(self, facts: Mapping[str, str]) -> None:
        for key, value in facts.items():
            if self.facts.get(key) != value:
                raise StoreError(
                    f"{self.file} was begun with another {key.replace('_', ' ')} "
                    f"({_short(self.facts.get(key))} there, {_short(value)} now); "
                    "write to another folder with --output, or delete this one"
                )

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        self._connection.execute("BEGIN IMMEDIATE")
        try:
            yield
        except BaseException:
            self._connection.execute("ROLLBACK")
            raise
        self._connection.execute("COMMIT")


def _column(name: str) -> str:
    if name not in Episode._fields:
        raise ValueError(f"no column {name!r}; columns are {', '.join(Episode._fields)}")
    return name


def _short(value: str | None) -> str:
    return "none" if value is None else value if len(value) < 64 else value[:12] + "…"
