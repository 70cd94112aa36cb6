"""The store of a score: every episode of every finished block, in SQLite.

Each start state is a block of its own here; those that were played in one batch are written in one transaction, so that
a process may be killed at any moment and the next one continues with the same batches.
What is read is never trusted: a store may have been damaged, edited or downloaded.
"""

import hashlib
import json
import sqlite3
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from shutil import disk_usage
from typing import Any, Final
from urllib.parse import quote

import msgspec

from overcooked_bench.errors import WrongUse
from overcooked_bench.evaluation.games.episode import COLUMNS, KEY, BlockKey, Episode, checksum, read_row, sql_columns
from overcooked_bench.evaluation.games.store_upgrades import UPGRADES

SCHEMA: Final = "2"
_TABLES: Final = (
    "CREATE TABLE facts (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID",
    "CREATE TABLE blocks (\n    layout TEXT, training_seed INTEGER, episode INTEGER, adapted INTEGER NOT NULL, "
    "sha256 TEXT NOT NULL,\n    PRIMARY KEY (layout, training_seed, episode)\n) WITHOUT ROWID",
    f"CREATE TABLE episodes (\n    {sql_columns()}\n)",
)
_ORDER: Final = ", ".join(KEY)
_BLOCK: Final = " AND ".join(f"{column} = ?" for column in KEY[:3])
_SELECT: Final = f"SELECT {', '.join(COLUMNS)} FROM episodes"
_DAMAGED: Final = "it is damaged or no store of episodes; delete it, or write to another folder with --output"
_EPISODE: Final = 2_000
"""Bytes of an episode besides its joint actions, which take less than 2 per step."""
_ROOM: Final = 20_000_000
"""Bytes of everything else that a score writes."""
_UNWRITABLE: Final = "finished blocks are kept; mend that and run the same command again, or choose another --output"


class StoreError(WrongUse):
    """A score's folder cannot be used; the message names the file and says what to do instead."""


class Store:
    """The episodes of one score.

    Args:
        file: The database; created if there is none.
        facts: What identifies the score (hashes of protocol, agent and pool); those of an existing store must be the
            same once it holds a finished block, and are replaced before. None opens an existing store to be read; one
            of an older schema is then upgraded in memory, and the file stays as it is.
        notes: What else is to be kept; not compared.

    Attributes:
        facts: Facts and notes of the store.

    Raises:
        StoreError: The file belongs to another score or to another version, is damaged, or cannot be opened.
    """

    def __init__(
        self, file: str | Path, facts: Mapping[str, str] | None = None, notes: Mapping[str, str] | None = None
    ) -> None:
        self.file = Path(file)
        if facts is None and not self.file.is_file():
            raise StoreError(f"{self.file}: no such file; give the folder of a score, or its episodes.sqlite")
        with self._guarded(_DAMAGED):
            if facts is not None:
                self.file.parent.mkdir(parents=True, exist_ok=True)
            address = f"file:{quote(str(self.file.absolute()))}?mode={'rw' if facts is None else 'rwc'}"
            self._connection = sqlite3.connect(address, uri=True, isolation_level=None, timeout=60)
        try:
            with self._guarded(_DAMAGED):
                if facts is None:
                    self._open_to_read()
                else:
                    self._open_to_write({**facts, "schema": SCHEMA}, notes or {})
                self.facts: dict[str, str] = self._read_facts()
        except BaseException:
            self.close()
            raise

    def __enter__(self) -> "Store":
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the file."""
        self._connection.close()

    def blocks(self) -> set[BlockKey]:
        """Lists the finished blocks: (layout, training seed, episode)."""
        with self._guarded(_DAMAGED):
            return set(self._connection.execute(f"SELECT {', '.join(KEY[:3])} FROM blocks"))

    def adapted(self) -> set[str]:
        """Lists the layouts that were played in their mirror image."""
        with self._guarded(_DAMAGED):
            return {layout for (layout,) in self._connection.execute("SELECT layout FROM blocks WHERE adapted")}

    def check_room(self, episodes: int, horizon: int) -> None:
        """Makes sure, before they are played, that some episodes can be written.

        Args:
            episodes: How many.
            horizon: Steps of each.

        Raises:
            StoreError: The file or its folder cannot be written, or the disk has too little room.
        """
        with self._guarded(_UNWRITABLE):
            with self._transaction():
                self._connection.execute("UPDATE facts SET value = value")
            free, needed = disk_usage(self.file.parent).free, _ROOM + episodes * (_EPISODE + 2 * horizon)
        if free < needed:
            raise StoreError(
                f"{self.file}: the disk has {free / 1e6:.0f} MB left, and {episodes:,} episodes may need "
                f"{needed / 1e6:.0f} MB; nothing was played. Make room, or choose another --output"
            )

    def add_block(self, block: BlockKey, episodes: Iterable[Episode], adapted: bool = False) -> None:
        """Writes a finished block; see `add_blocks`."""
        self.add_blocks({block: episodes}, adapted)

    def add_blocks(self, blocks: Mapping[BlockKey, Iterable[Episode]], adapted: bool = False) -> None:
        """Writes finished blocks at once, all or none; a block that is there already is left alone.

        Raises:
            StoreError: Another score has taken the store over since it was opened, or they cannot be written.
        """
        found = {block: list(episodes) for block, episodes in blocks.items()}
        with self._guarded(_UNWRITABLE), self._transaction():
            if self._read_facts() != self.facts:
                raise StoreError(f"{self.file} was taken over by another score; give each its own folder with --output")
            for block, rows in found.items():
                values = (*block, int(adapted), checksum(block, adapted, rows))
                written = self._connection.execute("INSERT OR IGNORE INTO blocks VALUES (?, ?, ?, ?, ?)", values)
                if written.rowcount:
                    marks = ", ".join("?" * len(COLUMNS))
                    self._connection.executemany(
                        f"INSERT INTO episodes VALUES ({marks})", map(msgspec.structs.astuple, rows)
                    )

    def note(self, key: str, value: str) -> None:
        """Writes a note about the score, which does not identify it, instead of what was there."""
        with self._guarded(_UNWRITABLE), self._transaction():
            entries = {**self._read_facts(), key: value}
            self._connection.execute("DELETE FROM facts")
            entries["checksum"] = _digest(entries)
            self._connection.executemany("INSERT INTO facts VALUES (?, ?)", sorted(entries.items()))
            self.facts = self._read_facts()

    def find(self, where: Mapping[str, str | int], worst: bool = False) -> Episode | None:
        """Reads the first episode that matches, in the order of its key.

        Args:
            where: Column of `Episode` -> value.
            worst: The one with the fewest points, floors and the agent's copies left out.

        Returns:
            The episode, or None if none matches.
        """
        conditions = [f"{_column(column)} = ?" for column in where] + (
            ["kind NOT IN ('floor', 'self')"] if worst else []
        )
        order = ("soup_reward, " if worst else "") + _ORDER
        query = f"SELECT {_ORDER} FROM episodes WHERE {' AND '.join(conditions) or '1'} ORDER BY {order} LIMIT 1"
        with self._guarded(_DAMAGED):
            key = self._connection.execute(query, tuple(where.values())).fetchone()
            if key is None:
                return None
            rows = self._block(key[:3])
            return next(row for row in rows if (*row.block, row.partner, row.seat) == key)

    def values(self, column: str) -> list[Any]:
        """Lists the different values of a column of `Episode`."""
        name = _column(column)
        with self._guarded(_DAMAGED):
            query = f"SELECT DISTINCT {name} FROM episodes ORDER BY {name}"
            return [value for (value,) in self._connection.execute(query)]

    def episodes(self) -> Iterator[Episode]:
        """Reads all episodes in the order of their key; every block is compared with its checksum.

        Raises:
            StoreError: A block is not as it was written.
        """
        with self._guarded(_DAMAGED):
            keys, total = sorted(self.blocks()), 0
            (stored,) = self._connection.execute("SELECT count(*) FROM episodes").fetchone()
        for key in keys:
            with self._guarded(_DAMAGED):
                rows = self._block(key)
            total += len(rows)
            yield from rows
        if total != stored:
            raise StoreError(f"{self.file}: {stored - total} episodes belong to no finished block; {_DAMAGED}")

    def _block(self, key: BlockKey) -> list[Episode]:
        adapted, expected = self._connection.execute(
            f"SELECT adapted, sha256 FROM blocks WHERE {_BLOCK}", key
        ).fetchone() or (0, "")
        rows = [read_row(row) for row in self._connection.execute(f"{_SELECT} WHERE {_BLOCK} ORDER BY {_ORDER}", key)]
        if checksum(key, bool(adapted), rows) != expected:
            raise StoreError(
                f"{self.file}: the block {key[0]}, training seed {key[1]}, episode {key[2]} was changed after it was "
                f"written (its checksum differs); {_DAMAGED}"
            )
        return rows

    def _open_to_read(self) -> None:
        self._connection.execute("PRAGMA query_only = ON")
        schema = self._schema()
        if schema is None:
            raise StoreError(f"{self.file}: not a store of episodes (it has no tables); {_DAMAGED}")
        if schema != SCHEMA:
            old, self._connection = self._connection, sqlite3.connect(":memory:", isolation_level=None)
            try:
                self._create()
                self._upgrade(old, schema)
            finally:
                old.close()
        self._check_tables(_TABLES)

    def _open_to_write(self, facts: Mapping[str, str], notes: Mapping[str, str]) -> None:
        """Writes what identifies the score, unless a finished block belongs to what is written there already."""
        if self._schema() == SCHEMA and self.blocks():
            self._check_tables(_TABLES)
            self._compare(facts)
            return
        with self._transaction():
            schema = self._schema()
            if schema is not None and self.blocks():
                self._compare(facts)
                return
            for name in ("facts", "blocks", "episodes"):
                self._connection.execute(f"DROP TABLE IF EXISTS {name}")
            self._create()
            entries = {**notes, **facts}
            entries["checksum"] = _digest(entries)
            self._connection.executemany("INSERT INTO facts VALUES (?, ?)", sorted(entries.items()))

    def _create(self) -> None:
        for statement in _TABLES:
            self._connection.execute(statement)

    def _upgrade(self, old: sqlite3.Connection, schema: str) -> None:
        """Copies a store of an older schema into this one, which is in memory."""
        if schema not in UPGRADES:
            raise StoreError(
                f"{self.file} has the schema {schema}; this version reads {SCHEMA} and {', '.join(UPGRADES)}"
            )
        facts, blocks = UPGRADES[schema](old)
        facts["schema"] = SCHEMA
        facts["checksum"] = _digest(facts)
        self._connection.executemany("INSERT INTO facts VALUES (?, ?)", sorted(facts.items()))
        self.facts = self._read_facts()
        for block, (adapted, rows) in blocks.items():
            self.add_block(block, rows, adapted)

    def _schema(self) -> str | None:
        """Returns the schema's number, or None if the file has no tables yet."""
        found = list(self._connection.execute("SELECT name, type FROM sqlite_master"))
        if not found:
            return None
        if not {("facts", "table"), ("blocks", "table"), ("episodes", "table")} <= set(found):
            raise StoreError(f"{self.file}: its tables are not those of a store of episodes; {_DAMAGED}")
        row = self._connection.execute("SELECT value FROM facts WHERE key = 'schema'").fetchone()
        return str(row[0]) if row else "none"

    def _check_tables(self, tables: Iterable[str]) -> None:
        """Makes sure that there is nothing but these tables: a view or a trigger would be executed."""
        query = "SELECT sql FROM sqlite_master WHERE name NOT LIKE 'sqlite~_%' ESCAPE '~'"
        if {sql for (sql,) in self._connection.execute(query)} != set(tables):
            raise StoreError(f"{self.file}: its tables are not those of schema {SCHEMA}; {_DAMAGED}")

    def _read_facts(self) -> dict[str, str]:
        facts = dict(self._connection.execute("SELECT key, value FROM facts"))
        expected = facts.pop("checksum", None)
        if _digest(facts) != expected:
            raise StoreError(f"{self.file}: what identifies the score was changed (its checksum differs); {_DAMAGED}")
        return facts

    def _compare(self, facts: Mapping[str, str]) -> None:
        schema = self._schema()
        if schema != SCHEMA:
            raise StoreError(
                f"{self.file} was written by another version (schema {schema}, this version writes {SCHEMA}), whose "
                "games had other random streams, so it cannot be continued; `overcooked-bench replay` still shows it. "
                "Write to another folder with --output, or delete this one"
            )
        known = self._read_facts()
        for key, value in facts.items():
            if known.get(key) != value:
                raise StoreError(
                    f"{self.file} belongs to another {key.replace('_', ' ')} "
                    f"({_short(known.get(key))} there, {_short(value)} now); "
                    "write to another folder with --output, or delete this one"
                )

    @contextmanager
    def _guarded(self, advice: str) -> Iterator[None]:
        """Turns everything that a damaged or unwritable file causes into a StoreError that names the file."""
        try:
            yield
        except StoreError:
            raise
        except (
            sqlite3.Error,
            OSError,
            ValueError,
            TypeError,
            LookupError,
            ArithmeticError,
            RecursionError,
            MemoryError,
        ) as error:
            raise StoreError(f"{self.file}: {type(error).__name__}: {error}; {advice}") from error

    @contextmanager
    def _transaction(self) -> Iterator[None]:
        self._connection.execute("BEGIN IMMEDIATE")
        try:
            yield
            self._connection.execute("COMMIT")
        except BaseException:
            with suppress(sqlite3.Error):  # a full disk has rolled it back already
                self._connection.execute("ROLLBACK")
            raise


def _digest(facts: Mapping[str, str]) -> str:
    return hashlib.sha256(json.dumps(sorted(facts.items())).encode()).hexdigest()


def _column(name: str) -> str:
    if name not in COLUMNS:
        raise ValueError(f"no column {name!r}; columns are {', '.join(COLUMNS)}")
    return name


def _short(value: str | None) -> str:
    return "none" if value is None else value if len(value) < 64 else value[:12] + "…"
