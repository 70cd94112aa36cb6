"""score.json, and the store of episodes: its bytes, and what SQL can make of it."""

import hashlib
import itertools
import json
import shutil
import sqlite3
from contextlib import closing, suppress
from pathlib import Path

import msgspec
import pytest

from overcooked_bench.evaluation.cells import read_cells
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.games.episode import COLUMNS, checksum, read_row
from overcooked_bench.evaluation.games.recording import find_recording, read_settings
from overcooked_bench.evaluation.games.replayed import check_returns
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.scores import ScoresError, read_scores
from tests.evaluation.games.test_store import FACTS
from tests.evaluation.made import block
from tests.fuzz.harness import TRIES, attack, mixed, seeded
from tests.fuzz.mutators import VALUES, as_json, bytes_of, trees_of

OLD = Path(__file__).parents[1] / "data" / "upgrades" / "score-1"


@TRIES
def test_scores(tries, tmp_path):
    file, seeds = tmp_path / "score.json", [path.read_bytes() for path in sorted(OLD.parent.rglob("score.json"))]

    def read(content: bytes) -> None:
        file.write_bytes(content)
        read_scores(file).write(tmp_path / "again.json")
        read_scores(tmp_path / "again.json")

    rng = seeded("scores")
    inputs = mixed(rng, bytes_of(seeds, rng), as_json(trees_of([json.loads(seed) for seed in seeds], rng)))
    attack("score.json", seeds, inputs, read, ScoresError, tries).check()


@pytest.fixture(scope="module")
def played(tmp_path_factory, tiny):
    """A store of two blocks, and one of the first schema."""
    file = tmp_path_factory.mktemp("store") / "episodes.sqlite"
    notes = {"settings": msgspec.json.encode(tiny).decode(), "agent_name": "greedy"}
    notes["partners"] = '{"cramped_room": {"greedy": ["scripted", null], "random": ["scripted", "a"]}}'
    with Store(file, FACTS, notes) as store:
        for index in range(2):
            outcome = play_block(block(tiny, episodes=(index,)))
            store.add_blocks(outcome.by_key)
    return file


def read_store(file: Path) -> None:
    """Does all that commands do with a store: replays every episode, scores them, and shows the worst one."""
    with Store(file) as store:
        rules = read_settings(store).play
        check_returns(store, rules.cooking, rules.horizon)
        store.adapted()
        read_cells(store, [layout for layout in rules.layouts if layout == "cramped_room"], 1, 2, rules.seats)
    with suppress(StopIteration):
        next(find_recording(file, worst=True).frames())


@TRIES
def test_bytes_of_stores(tries, played, tmp_path):
    file = tmp_path / "episodes.sqlite"

    def read(content: bytes) -> None:
        file.write_bytes(content)
        read_store(file)

    whole = [played.read_bytes()]
    attack("episodes.sqlite, bytes", whole, bytes_of(whole, seeded("bytes")), read, StoreError, tries).check()


FACTS_KEYS = ("settings", "partners", "agent_name", "agent", "schema", "checksum")
COLUMNS_OF = {"episodes": COLUMNS, "blocks": ("layout", "episode", "adapted"), "facts": ("key", "value")}


def statements(rng):
    """Draws edits: a column, a fact or a table, and what it is made to be."""
    values = [value for value in VALUES if not isinstance(value, list | dict | bool)]
    values += [b"", b"\xff\xfe", b"x\x9c", "[" * 3000, "{}", "greedy", b"\0" * 1000]
    for value in (rng.choice(values) for _ in itertools.count()):
        fits = value if not isinstance(value, int) or abs(value) < 2**63 else str(value)[:100]
        table, where = rng.choice(("episodes", "episodes", "blocks", "facts")), rng.choice(("", " WHERE rowid % 3 = 1"))
        column = rng.choice(
            {"episodes": COLUMNS, "blocks": ("layout", "episode", "adapted"), "facts": ("key", "value")}[table]
        )
        if table != "episodes":
            where = f" WHERE key = '{rng.choice(FACTS_KEYS)}'" if table == "facts" else ""
        yield rng.choice(
            [(f"UPDATE {table} SET {column} = ?{where}", (fits,))] * 8
            + [
                (f"DELETE FROM {table}{where}", ()),
                (f"UPDATE {table} SET {column} = CAST(X'FF00' AS TEXT)", ()),
                (f"UPDATE {table} SET {column} = {column} || 'x'", ()),
                (f"UPDATE {table} SET {column} = {column} + 1", ()),
                (f"ALTER TABLE {table} DROP COLUMN {column}", ()),
                (f"ALTER TABLE {table} RENAME COLUMN {column} TO other", ()),
                (f"DROP TABLE {table}", ()),
                (f"CREATE VIEW v AS SELECT * FROM {table}", ()),
            ]
        )


def forge(file: Path) -> None:
    """Makes all checksums match what is there now, as far as that can be done."""
    with suppress(sqlite3.Error, ValueError, TypeError), closing(sqlite3.connect(file)) as connection, connection:
        facts = dict(connection.execute("SELECT key, value FROM facts WHERE key != 'checksum'"))
        digest = hashlib.sha256(json.dumps(sorted(facts.items())).encode()).hexdigest()
        connection.execute("UPDATE facts SET value = ? WHERE key = 'checksum'", (digest,))
        rows = [read_row(row) for row in connection.execute(f"SELECT {', '.join(COLUMNS)} FROM episodes")]
        for *key, adapted in list(connection.execute("SELECT layout, training_seed, episode, adapted FROM blocks")):
            digest = checksum(tuple(key), bool(adapted), [row for row in rows if row.block == tuple(key)])
            where = "layout = ? AND training_seed = ? AND episode = ?"
            connection.execute(f"UPDATE blocks SET sha256 = ? WHERE {where}", (digest, *key))


@pytest.mark.slow
@TRIES
def test_edits_of_stores(tries, played, tmp_path):
    file, rng = tmp_path / "episodes.sqlite", seeded("edits")
    edits = statements(rng)

    def changed():
        for number in itertools.count():
            shutil.copy(played if number % 4 else OLD / "episodes.sqlite", file)
            with closing(sqlite3.connect(file)) as connection:
                for statement, values in itertools.islice(edits, rng.choice((1, 1, 2))):
                    with suppress(sqlite3.Error, UnicodeEncodeError, OverflowError), connection:
                        connection.execute(statement, values)
            forge(file)
            yield b""

    shutil.copy(played, file)
    attack("episodes.sqlite, SQL", [b""], changed(), lambda _: read_store(file), StoreError, tries).check()
