"""A store that was damaged, edited, downloaded or written by an older version: one error that names the file."""

import contextlib
import random
import shutil
import sqlite3
import zlib
from contextlib import closing
from pathlib import Path
from types import SimpleNamespace

import msgspec
import numpy as np
import pytest

from overcooked_bench.cli import main
from overcooked_bench.evaluation.games import store as disk
from overcooked_bench.evaluation.games.block import play_block
from overcooked_bench.evaluation.games.episode import COLUMNS, Episode, checksum, pack_actions, pack_state
from overcooked_bench.evaluation.games.recording import find_recording
from overcooked_bench.evaluation.games.replayed import check_returns, read_settings
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.kitchen.layout import Layout
from overcooked_bench.kitchen.state import Chef, KitchenState, Soup
from tests.evaluation.games.test_store import FACTS, episode
from tests.evaluation.made import block

OLD = Path(__file__).parents[2] / "data" / "upgrades" / "score-1"
BLOCK = ("cramped_room", 0, 0)


@pytest.fixture(scope="module")
def played(tmp_path_factory, tiny):
    """A store of two blocks of a real score."""
    file = tmp_path_factory.mktemp("store") / "episodes.sqlite"
    notes = {"settings": msgspec.json.encode(tiny).decode(), "agent_name": "greedy"}
    with Store(file, FACTS, notes) as store:
        for index in range(2):
            outcome = play_block(block(tiny, episodes=(index,)))
            store.add_blocks(outcome.by_key)
    return file


@pytest.fixture
def copy(played, tmp_path):
    return Path(shutil.copy(played, tmp_path))


def edit(file, *statements):
    with closing(sqlite3.connect(file)) as connection, connection:
        for statement in statements:
            connection.execute(*([statement] if isinstance(statement, str) else statement))


def forge(file, **changes):
    """Edits the first episode and makes the block's checksum match, as somebody who knows the format would."""
    with Store(file) as store:
        first, *others = [one for one in store.episodes() if one.block == BLOCK]
    forged = msgspec.structs.replace(first, **changes)
    edit(
        file,
        (f"UPDATE episodes SET {', '.join(f'{c} = ?' for c in changes)} WHERE rowid = (SELECT rowid FROM episodes "
         "WHERE layout = ? AND training_seed = ? AND episode = ? AND partner = ? AND seat = ?)",
         (*changes.values(), *first.block, first.partner, first.seat)),
        ("UPDATE blocks SET sha256 = ? WHERE episode = 0", (checksum(BLOCK, False, [forged, *others]),)),
    )  # fmt: skip
    return first


def read(file, tiny):
    """Reads and replays everything, as resuming does."""
    with Store(file) as store:
        check_returns(store, tiny.play.cooking, tiny.play.horizon)
        return store.facts, store.blocks(), list(store.episodes())


def replay_all(file):
    with Store(file) as store:
        rules = read_settings(store)
        return check_returns(store, rules.play.cooking, rules.play.horizon)


def test_what_was_played_replays_to_the_same_points(played, tiny):
    with Store(played) as store:
        assert check_returns(store, tiny.play.cooking, tiny.play.horizon) == 8
        sides = {one.side for one in store.episodes()}
    assert sides == {0}


@pytest.mark.parametrize(
    "statement",
    [
        "UPDATE episodes SET soup_reward = 400",
        "UPDATE episodes SET ego_soups = 3 WHERE seat = 1",
        "UPDATE episodes SET partner_sha256 = 'x' WHERE partner = 'greedy'",
        "UPDATE blocks SET adapted = 1 WHERE episode = 1",
        "DELETE FROM episodes WHERE seat = 0",
        "INSERT INTO episodes SELECT layout, training_seed, episode, 'twin', "
        + ", ".join(COLUMNS[4:])
        + " FROM episodes WHERE partner = 'greedy'",
    ],
)
def test_an_edited_block_is_refused(statement, copy, tiny):
    edit(copy, statement)
    with pytest.raises(StoreError, match=rf"{copy}: the block cramped_room, training seed 0, episode .* was changed"):
        read(copy, tiny)


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("DELETE FROM blocks WHERE episode = 1", "4 episodes belong to no finished block"),
        ("UPDATE facts SET value = 'me' WHERE key = 'agent_name'", "what identifies the score was changed"),
        ("DELETE FROM facts WHERE key = 'checksum'", "what identifies the score was changed"),
        ("UPDATE episodes SET soup_reward = 'many'", "Expected `float`, got `str`, in the column 'soup_reward'"),
        ("UPDATE episodes SET soup_reward = 9e999", "in the column 'soup_reward'"),
        ("UPDATE episodes SET seat = 2 WHERE seat = 1", "in the column 'seat'"),
        ("UPDATE episodes SET ego_soups = -1", "in the column 'ego_soups'"),
        ("UPDATE episodes SET actions = 'x'", "in the column 'actions'"),
        ("UPDATE episodes SET start = CAST(X'FF' AS TEXT)", "UTF-8"),
        ("DROP TABLE blocks", "not those of a store"),
        ("CREATE TRIGGER t AFTER INSERT ON blocks BEGIN DELETE FROM episodes; END", "not those of schema 2"),
        ("ALTER TABLE episodes ADD COLUMN more", "not those of schema 2"),
    ],
)
def test_impossible_content_is_refused(statement, words, copy, tiny):
    edit(copy, statement)
    with pytest.raises(StoreError, match=words) as refused:
        read(copy, tiny)
    assert str(copy) in str(refused.value)


def test_a_view_in_place_of_a_table_is_not_executed(copy):
    endless = "WITH RECURSIVE n(i) AS (SELECT 1 UNION ALL SELECT i + 1 FROM n) SELECT i AS key, i AS value FROM n"
    edit(copy, "DROP TABLE facts", f"CREATE VIEW facts AS {endless}")
    with pytest.raises(StoreError, match="not those of a store"):
        Store(copy)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"soup_reward": 400.0}, "soup_reward is 400, but its joint actions bring"),
        ({"ego_partial_reward": 7.0}, "ego_partial_reward is 7, but"),
        ({"partner_soups": 9}, "partner_soups is 9, but"),
        ({"start": "{}"}, "not a state in overcooked_ai's JSON form"),
        ({"start": "[" * 5000}, "cannot be replayed"),
        ({"actions": b"no zlib"}, "cannot be unpacked"),
        ({"actions": zlib.compress(b"\x04" * 78)}, "not those of 40 steps"),
        ({"actions": zlib.compress(b"\x06" * 80)}, "none of 0 to 5"),
        ({"layout": "nowhere"}, "no finished block|no layout named|was changed"),
    ],
)
def test_a_forged_episode_is_found_by_its_replay(changes, words, copy, tiny):
    first = forge(copy, **changes)
    with pytest.raises(StoreError, match=words) as refused:
        read(copy, tiny)
    assert str(copy) in str(refused.value)
    if "layout" not in changes:
        assert f"{first.cell}" in str(refused.value)


def test_soups_that_nobody_pays_for_are_replayed_too(tmp_path):
    """One onion is no order here: the soup is served, and brings nothing."""
    served = Chef((3, 2), "south", Soup((1, 0), 20, 20))
    start = KitchenState((Chef((1, 1)), served), orders=((3, 0),))
    actions = pack_actions(np.array([[4, 5], [4, 4]], np.uint8))
    one = Episode(
        *("cramped_room", 0, 0, "cook", 1, 0, "c" * 64, "scripted", 0.0, 0.0, 0.0, 1, 0, pack_state(start), actions)
    )
    with Store(tmp_path / "episodes.sqlite", FACTS) as store:
        store.add_block(one.block, [one])
        assert check_returns(store, "auto", 2) == 1
    with Store(tmp_path / "other.sqlite", FACTS) as store:
        store.add_block(one.block, [msgspec.structs.replace(one, ego_soups=2)])
        with pytest.raises(StoreError, match="ego_soups is 2, but its joint actions bring 1"):
            check_returns(store, "auto", 2)


def test_a_forged_episode_is_not_shown(copy, capsys):
    forge(copy, soup_reward=400.0)
    with pytest.raises(StoreError, match="joint actions bring"):
        list(find_recording(copy, partner="greedy", seat=0, episode=0).frames())
    forge(copy, start="{}")
    assert main(["replay", str(copy)]) == 2
    assert str(copy) in capsys.readouterr().err


def test_a_compressed_bomb_is_not_unpacked(copy):
    first = forge(copy, actions=zlib.compress(bytes(300_000_000), 9))
    recording = find_recording(copy, partner=first.partner, seat=first.seat)
    import tracemalloc

    tracemalloc.start()
    with pytest.raises(StoreError, match="not those of 40 steps"):
        list(recording.frames())
    assert tracemalloc.get_traced_memory()[1] < 20_000_000
    tracemalloc.stop()


@pytest.mark.parametrize("seed", range(4))
def test_damaged_bytes_never_change_what_is_read_in_silence(seed, played, copy, tiny):
    whole, draw = read(played, tiny), random.Random(seed)
    data = played.read_bytes()
    for _ in range(60):
        damaged = bytearray(data)
        for _ in range(draw.randint(1, 3)):
            damaged[draw.randrange(len(data))] = draw.randrange(256)
        copy.write_bytes(damaged[: draw.randrange(len(data))] if draw.random() < 0.2 else damaged)
        with contextlib.suppress(StoreError):
            assert read(copy, tiny) == whole


def test_a_full_disk_is_one_message_and_finished_blocks_stay(tmp_path):
    with Store(tmp_path / "episodes.sqlite", FACTS) as store:
        store.add_block(BLOCK, [episode()])
        (pages,) = store._connection.execute("PRAGMA page_count").fetchone()
        store._connection.execute(f"PRAGMA max_page_count = {pages}")
        large = [episode(partner=f"p{i}", index=1) for i in range(500)]
        with pytest.raises(StoreError, match=r"episodes\.sqlite: .*full; finished blocks are kept"):
            store.add_block(("cramped_room", 0, 1), large)
        assert store.blocks() == {BLOCK}
    with Store(tmp_path / "episodes.sqlite", FACTS) as store:
        store.add_block(("cramped_room", 0, 1), large)
        assert len(list(store.episodes())) == 501


def test_a_lack_of_room_is_found_before_anything_is_played(tmp_path, monkeypatch):
    with Store(tmp_path / "episodes.sqlite", FACTS) as store:
        store.check_room(10**6, 400)
        monkeypatch.setattr(disk, "disk_usage", lambda _: SimpleNamespace(free=10**8))
        store.check_room(25_000, 400)
        with pytest.raises(StoreError, match="has 100 MB left, and 30,000 episodes may need 104 MB; nothing was pl"):
            store.check_room(30_000, 400)


def test_a_store_that_cannot_be_written_is_found_before_anything_is_played(tmp_path):
    with Store(tmp_path / "episodes.sqlite", FACTS) as store:
        store._connection.execute("PRAGMA query_only = ON")  # as on a disk that is read-only
        with pytest.raises(StoreError, match=r"episodes\.sqlite: .*readonly database; finished blocks are kept"):
            store.check_room(1, 400)
    with pytest.raises(StoreError, match=r"/proc/nowhere/episodes\.sqlite"):
        Store("/proc/nowhere/episodes.sqlite", FACTS)


def test_a_folder_removed_midway_is_one_message(tmp_path):
    with Store(tmp_path / "gone" / "episodes.sqlite", FACTS) as store:
        shutil.rmtree(tmp_path / "gone")
        with pytest.raises(StoreError, match=r"gone/episodes\.sqlite"):
            store.add_block(BLOCK, [episode()])


@pytest.mark.parametrize("make", ["mkdir", "link", "parent"])
def test_something_else_in_the_files_place_is_one_message(make, tmp_path):
    file = tmp_path / "out" / "episodes.sqlite"
    if make == "parent":
        (tmp_path / "out").touch()
    elif make == "mkdir":
        file.mkdir(parents=True)
    else:
        file.parent.mkdir()
        file.symlink_to(tmp_path / "nowhere" / "else.sqlite")
    with pytest.raises(StoreError, match=r"out/episodes\.sqlite"):
        Store(file, FACTS)


def test_a_name_that_looks_like_an_address_is_a_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with Store("file:x?mode=ro/episodes.sqlite", FACTS) as store:
        store.add_block(BLOCK, [episode()])
    assert (tmp_path / "file:x?mode=ro" / "episodes.sqlite").is_file()


def test_a_finished_store_is_opened_without_writing(copy, tiny):
    with closing(sqlite3.connect(copy, isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")  # nobody else can write now
        with Store(copy, FACTS) as store:
            assert len(store.blocks()) == 2


def test_a_store_of_schema_1_is_read_and_left_as_it_is(tmp_path):
    file = Path(shutil.copy(OLD / "episodes.sqlite", tmp_path))
    with Store(file) as store:
        rules = read_settings(store)
        assert check_returns(store, rules.play.cooking, rules.play.horizon) == 72
        found = list(store.episodes())
        assert store.facts["agent_name"] == "greedy"
    assert file.read_bytes() == (OLD / "episodes.sqlite").read_bytes()
    assert {one.side for one in found if one.layout == "cramped_room"} == {0}
    apart = Layout.load("forced_coordination")
    for one in found:
        if one.layout == "forced_coordination":
            assert one.side == apart.regions[one.first_state.chefs[one.seat].position]
    assert {one.side for one in found} == {0, 1}


def test_a_recording_of_schema_1_is_shown(capsys):
    assert main(["replay", str(OLD), "--layout", "forced_coordination", "--worst", "--every", "50"]) == 0
    assert "greedy" in capsys.readouterr().out


def test_a_store_of_schema_1_is_not_continued(tmp_path):
    file = Path(shutil.copy(OLD / "episodes.sqlite", tmp_path))
    with pytest.raises(StoreError, match=r"schema 1, .*other random streams.*replay.*--output"):
        Store(file, FACTS)
    assert file.read_bytes() == (OLD / "episodes.sqlite").read_bytes()


def test_a_store_of_schema_1_without_a_finished_block_is_taken_over(tmp_path):
    file = Path(shutil.copy(OLD / "episodes.sqlite", tmp_path))
    edit(file, "DELETE FROM blocks", "DELETE FROM episodes")
    with Store(file, FACTS) as store:
        store.add_block(BLOCK, [episode()])
        assert store.facts["schema"] == "2"


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        ("UPDATE episodes SET soup_reward = 400", "soup_reward is 400, but its joint actions bring"),
        ("DELETE FROM blocks WHERE episode = 1", "KeyError"),
        ("UPDATE episodes SET start = '{}'", "not a state"),
        ("UPDATE facts SET value = '{' WHERE key = 'settings'", "the protocol that it was played under"),
    ],
)
def test_an_edited_store_of_schema_1_is_refused(statement, words, tmp_path):
    file = Path(shutil.copy(OLD / "episodes.sqlite", tmp_path))
    edit(file, statement)
    with pytest.raises(StoreError, match=words):
        replay_all(file)
