import sqlite3
from itertools import islice

import numpy as np
import pytest

from overcooked_bench.evaluation.games.episode import Episode, pack_actions
from overcooked_bench.evaluation.games.store import Store, StoreError

FACTS = {"protocol": "a" * 64, "agent": "b" * 64, "pool": "none", "seed": "0"}
ACTIONS = np.arange(12, dtype=np.uint8).reshape(6, 2) % 6


def episode(partner="greedy", seat=0, layout="cramped_room", points=20.0, index=0, kind="scripted"):
    blob = pack_actions(ACTIONS)
    return Episode(layout, 0, index, partner, seat, 0, "c" * 64, kind, points, 3.0, 5.0, 1, 0, "{}", blob)


def test_what_is_written_is_read_back(tmp_path):
    with Store(tmp_path / "new" / "episodes.sqlite", FACTS, {"agent_name": "me"}) as store:
        store.add_block(("cramped_room", 0, 0), [episode(seat=1), episode(seat=0)], adapted=True)
    with Store(tmp_path / "new" / "episodes.sqlite") as store:
        assert store.facts == {**FACTS, "agent_name": "me", "schema": "2"}
        assert list(store.episodes()) == [episode(seat=0), episode(seat=1)]
        assert (next(store.episodes()).joint_actions(6) == ACTIONS).all()
        assert store.blocks() == {("cramped_room", 0, 0)}
        assert store.adapted() == {"cramped_room"}


def test_a_block_is_written_whole_or_not_at_all(tmp_path):
    def breaks_off():
        yield from islice((episode(seat=seat) for seat in (0, 1)), 1)
        raise KeyboardInterrupt

    with Store(tmp_path / "episodes.sqlite", FACTS) as store:
        with pytest.raises(KeyboardInterrupt):
            store.add_block(("cramped_room", 0, 0), breaks_off())
        assert store.blocks() == set()
        assert list(store.episodes()) == []
        store.add_block(("cramped_room", 0, 0), [episode()])
        store.add_block(("cramped_room", 0, 0), [episode(points=999.0)])
        assert [found.soup_reward for found in store.episodes()] == [20.0]


@pytest.mark.parametrize("key", FACTS)
def test_another_scores_folder_is_refused(key, tmp_path):
    with Store(tmp_path / "episodes.sqlite", FACTS) as store:
        store.add_block(("cramped_room", 0, 0), [episode()])
    Store(tmp_path / "episodes.sqlite", FACTS, {"agent_name": "renamed"}).close()
    with pytest.raises(StoreError, match=f"belongs to another {key} .*--output"):
        Store(tmp_path / "episodes.sqlite", {**FACTS, key: "d" * 64})


def test_without_a_finished_block_another_score_takes_the_store_over(tmp_path):
    first = Store(tmp_path / "episodes.sqlite", FACTS, {"agent_name": "before"})
    with Store(tmp_path / "episodes.sqlite", {**FACTS, "agent": "d" * 64}, {"agent_name": "after"}) as store:
        assert (store.facts["agent"], store.facts["agent_name"]) == ("d" * 64, "after")
    with first, pytest.raises(StoreError, match="taken over by another score"):
        first.add_block(("cramped_room", 0, 0), [episode()])
    with Store(tmp_path / "episodes.sqlite") as store:
        assert store.blocks() == set()


def test_a_store_of_another_version_is_refused(tmp_path):
    Store(tmp_path / "episodes.sqlite", FACTS).close()
    connection = sqlite3.connect(tmp_path / "episodes.sqlite")
    with connection:
        connection.execute("UPDATE facts SET value = '9' WHERE key = 'schema'")
    connection.close()
    with pytest.raises(StoreError, match="has the schema 9; this version reads 2 and 1"):
        Store(tmp_path / "episodes.sqlite")


@pytest.mark.parametrize("facts", [None, FACTS])
def test_a_file_that_is_no_store_is_refused(facts, tmp_path):
    (tmp_path / "episodes.sqlite").write_text("not a database, but some text that is long enough " * 40)
    with pytest.raises(StoreError, match=r"episodes.sqlite: .*damaged or no store of episodes"):
        Store(tmp_path / "episodes.sqlite", facts)


def test_an_empty_file_is_not_read_as_a_store_and_a_missing_one_is_not_made(tmp_path):
    (tmp_path / "empty.sqlite").touch()
    with pytest.raises(StoreError, match="not a store of episodes"):
        Store(tmp_path / "empty.sqlite")
    with pytest.raises(StoreError, match="no such file"):
        Store(tmp_path / "missing.sqlite")
    assert not (tmp_path / "missing.sqlite").exists()


def test_episodes_are_found_by_column(tmp_path):
    with Store(tmp_path / "episodes.sqlite", FACTS) as store:
        rows = [
            episode("greedy", 0, points=40.0),
            episode("greedy", 1, points=20.0),
            episode("stay", 0, points=0.0, kind="floor"),
        ]
        store.add_block(("cramped_room", 0, 0), rows)
        assert store.find({}) == rows[0]
        assert store.find({}, worst=True) == rows[1]
        assert store.find({"partner": "stay"}) == rows[2]
        assert store.find({"partner": "stay", "seat": 1}) is None
        assert store.values("partner") == ["greedy", "stay"]
        with pytest.raises(ValueError, match="no column 'seat; DROP'"):
            store.find({"seat; DROP": 1})
