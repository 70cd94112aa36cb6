"""The main job end to end: resumed, killed, spread over workers, and stopped by a fault."""

import contextlib
import os
import re
import signal
import sqlite3
import subprocess
import sys
import time

import msgspec
import pytest

from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.pools.records import Bound
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.cli import main
from overcooked_bench.evaluation.cells import SideBound
from overcooked_bench.evaluation.games.apart import EngineError
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.protocol import ProtocolError, read_protocol
from overcooked_bench.evaluation.scores import EPISODES_FILE, SCORES_FILE, read_scores
from overcooked_bench.evaluation.summary import recompute
from overcooked_bench.kitchen.layout import CLASSIC
from tests.agents.made import scripted
from tests.evaluation.made import SCRIPTED_POOL, changed, protocol_text, reporting, score, write_agent


def without_run(folder):
    text = (folder / SCORES_FILE).read_text()
    return text[: text.index('"run"')]


def blocks(folder):
    with Store(folder / EPISODES_FILE) as store:
        return store.blocks()


def test_a_score_is_written_and_read_back(protocol, pool_folder, tmp_path):
    seen = []
    scores, folder, *_ = score("greedy", protocol, pool=pool_folder, output=tmp_path / "out", on_progress=seen.append)
    assert sorted(file.name for file in folder.iterdir()) == [
        "curve.png",
        "episodes.sqlite",
        "report.html",
        "score.json",
    ]
    assert read_scores(folder / SCORES_FILE) == scores
    assert (scores.agent.name, scores.pool.name, scores.training_seeds) == ("greedy", "tiny", 1)
    (layout,) = scores.layouts
    assert {label.name: (label.kind, label.is_ego) for label in layout.partners if label.counts} == {
        "greedy": ("scripted", True),
        "sp-0": ("trained", False),
        "sp-1": ("trained", False),
    }
    assert [(at.done, at.of, at.episodes) for at in seen] == [(1, 1, 16)]
    assert set(scores.run) >= {"seconds", "workers", "engine", "versions"}


@pytest.fixture(scope="module")
def by_one_worker(pool_folder, tmp_path_factory):
    """A submission, what it is scored under, and its score by one worker."""
    home = tmp_path_factory.mktemp("one")
    protocol = read_protocol(protocol_text(episodes=3), "p.yaml")
    agent = write_agent(home / "agent.py", act="return np.random.randint(0, 6, n)", training_seeds=2)
    score(agent, protocol, pool=pool_folder, output=home / "out")
    return agent, protocol, home / "out"


@pytest.mark.slow
@pytest.mark.parametrize("engine", ["local", "dask", "ray"])
def test_two_workers_of_any_engine_write_the_same_bytes_as_one(engine, by_one_worker, pool_folder, tmp_path):
    agent, protocol, before = by_one_worker
    relative = os.path.relpath(agent)  # to where the score is started
    score(relative, protocol, pool=pool_folder, output=tmp_path / "out", workers=2, engine=engine)
    assert without_run(tmp_path / "out") == without_run(before)
    with Store(tmp_path / "out" / EPISODES_FILE) as one, Store(before / EPISODES_FILE) as two:
        assert list(one.episodes()) == list(two.episodes())


SCORE = "import sys; from overcooked_bench.cli import main; sys.exit(main(sys.argv[1:]))"


@pytest.mark.slow
def test_a_killed_score_goes_on_where_it_was(tmp_path):
    rules = tmp_path / "p.yaml"
    rules.write_text(protocol_text(layouts=list(CLASSIC), episodes=12, horizon=400))
    arguments = ["score", "greedy", "--protocol", str(rules), "--output", str(tmp_path / "killed"), "--workers", "1"]
    process = subprocess.Popen([sys.executable, "-c", SCORE, *arguments], stdout=subprocess.DEVNULL)
    file, give_up = tmp_path / "killed" / EPISODES_FILE, time.monotonic() + 120
    while time.monotonic() < give_up and not (file.exists() and _count(file)):
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert not (tmp_path / "killed" / SCORES_FILE).exists()
    before = blocks(tmp_path / "killed")
    assert len(before) in {12, 24, 36, 48}, "blocks are written whole"
    played = []
    protocol = read_protocol(rules.read_text(), "p.yaml")
    score("greedy", protocol, output=tmp_path / "killed", on_progress=played.append)
    assert len(played) == 5 - len(before) / 12
    score("greedy", protocol, output=tmp_path / "whole")
    assert without_run(tmp_path / "killed") == without_run(tmp_path / "whole")


def _count(file):
    connection = sqlite3.connect(file, timeout=10)
    try:
        return connection.execute("SELECT count(*) FROM blocks").fetchone()[0]
    except sqlite3.OperationalError:  # no tables yet
        return 0
    finally:
        connection.close()


def test_a_finished_score_is_not_played_again_and_another_is_refused(protocol, tmp_path):
    score("greedy", protocol, output=tmp_path / "out")
    again = []
    assert score("greedy", protocol, output=tmp_path / "out", on_progress=again.append).episodes == 0
    assert again == []
    with pytest.raises(StoreError, match="belongs to another agent"):
        score("stay", protocol, output=tmp_path / "out")
    with pytest.raises(StoreError, match="belongs to another seed"):
        score("greedy", protocol, output=tmp_path / "out", seed=1)


def test_a_return_edited_in_the_store_is_not_scored(protocol, tmp_path):
    score("greedy", protocol, output=tmp_path / "out")
    written = (tmp_path / "out" / SCORES_FILE).read_bytes()
    with contextlib.closing(sqlite3.connect(tmp_path / "out" / EPISODES_FILE)) as connection, connection:
        connection.execute("UPDATE episodes SET soup_reward = 400")
    with pytest.raises(StoreError, match=r"out/episodes.sqlite: the block cramped_room, .* was changed"):
        score("greedy", protocol, output=tmp_path / "out")
    assert (tmp_path / "out" / SCORES_FILE).read_bytes() == written


@pytest.mark.slow
def test_a_fault_ends_its_own_block_and_no_other(tmp_path):
    rules = read_protocol(protocol_text(layouts=["cramped_room", "coordination_ring"]), "p.yaml")
    act = "return np.full(n, 6 if self.training_seed == 1 and self.layout == 'cramped_room' else 4)"
    agent = write_agent(tmp_path / "agent.py", act=act, training_seeds=2)
    scores, folder, episodes, _ = score(agent, rules, output=tmp_path / "out")
    where = r"cramped_room, training seed 1, episode 0, partner .*, seat .*, step 0: .*action 6"
    assert [bool(re.match(where, fault)) for fault in scores.faults] == [True]
    done = {(layout, run, e) for layout in rules.play.layouts for run in (0, 1) for e in (0, 1)}
    assert blocks(folder) == done - {("cramped_room", 1, 0), ("cramped_room", 1, 1)}
    assert episodes == 24
    assert [layout.layout for layout in scores.layouts] == ["coordination_ring"]
    assert (scores.overall, scores.unranked) == (None, "cramped_room not played to the end")
    assert read_scores(folder) == scores
    assert scores.faults[0].split(":")[0] in (folder / "report.html").read_text()


def test_a_corrected_agent_is_scored_in_the_same_folder(protocol, tmp_path):
    agent = write_agent(tmp_path / "agent.py", act="raise SystemExit(0)")
    assert "SystemExit: 0" in score(agent, protocol, output=tmp_path / "out").scores.faults[0]
    assert score(write_agent(agent), protocol, output=tmp_path / "out").scores.faults == ()
    assert len(blocks(tmp_path / "out")) == 2


@pytest.mark.slow
def test_after_a_fault_in_a_worker_too(tmp_path):
    rules = read_protocol(protocol_text(layouts=["cramped_room", "coordination_ring"]), "p.yaml")
    agent = write_agent(tmp_path / "agent.py", act="return np.full(n, 4.5)")
    scores = score(agent, rules, output=tmp_path / "out", workers=2).scores
    assert [bool(re.search(r"step 0: .*float64", fault)) for fault in scores.faults] == [True, True]


@pytest.mark.parametrize(
    ("act", "why", "workers"),
    [
        ("import os; os._exit(0)", "act, step 0: the worker process ended with exit code 0", 1),
        ("import os; os.abort()", "act, step 0: the worker process was ended by SIGABRT", 2),
        ("while True: pass", "act, step 0: no answer within 2 s", 1),
    ],
)
@pytest.mark.slow
def test_an_agent_that_ends_or_blocks_its_process_is_at_fault(act, why, workers, protocol, tmp_path):
    agent = write_agent(tmp_path / "agent.py", act=act)
    scores = score(agent, protocol, output=tmp_path / "out", workers=workers, act_timeout=2).scores
    assert re.match(rf"cramped_room, training seed 0, episodes 0 to 1: {why}", scores.faults[0])


@pytest.mark.slow
def test_long_faults_with_control_characters_are_one_line(protocol, tmp_path):
    agent = write_agent(tmp_path / "agent.py", act="raise ValueError('\\x1b[31m\\n' + 'x' * 700_000)")
    fault = score(agent, protocol, output=tmp_path / "out").scores.faults[0]
    assert len(fault) <= 1100
    assert fault.isprintable()


GRID = "XXPXX\nO   O\nX   X\nXDXSX"


@pytest.fixture
def own_kitchen(tmp_path):
    """A layout file of the user's own, and a pool of scripted partners for it."""
    (tmp_path / "bare.layout").write_text(GRID)
    write_manifest(tmp_path / "pool", "own", [scripted("greedy", layout=GRID)])
    return {"layouts": [str(tmp_path / "bare.layout")], "pool": tmp_path / "pool"}


def test_a_kitchen_of_ones_own_is_scored_with_scripted_partners(own_kitchen, tmp_path):
    scores, *_ = score("stay", read_protocol(protocol_text(**own_kitchen), "p.yaml"), output=tmp_path / "out")
    assert [label.name for label in scores.layouts[0].partners] == ["greedy"]


def test_a_standard_start_needs_start_cells(own_kitchen, tmp_path):
    rules = read_protocol(protocol_text(**own_kitchen, start="standard"), "p.yaml")
    with pytest.raises(ProtocolError, match="names no start cells"):
        score("stay", rules, output=tmp_path / "out")


def test_without_a_pool_nobody_is_met(protocol, tmp_path):
    with pytest.raises(ProtocolError, match="names no pool; name one with --pool"):
        score("stay", changed(protocol, pool=None), output=tmp_path / "out")
    scores, *_ = score("stay", changed(protocol, pool=None), pool=SCRIPTED_POOL, output=tmp_path / "out")
    assert scores.pool.name == "scripted"


def test_a_pool_of_the_same_name_and_other_content_is_refused(protocol, tmp_path):
    pinned = changed(protocol, pool_sha256="0" * 64)
    with pytest.raises(
        ProtocolError, match=r"means the pool .* with the hash 000.*, but the one here has [0-9a-f]{64}"
    ):
        score("stay", pinned, output=tmp_path / "out")
    assert score("stay", pinned, pool=SCRIPTED_POOL, output=tmp_path / "out").scores.pool.name == "scripted"


def test_what_the_pool_says_of_partners_is_in_the_score(protocol, tmp_path):
    bound = dict(floor_agent="stay", low=90, high=110, episodes=9, responder="greedy", responder_sha256="0" * 64)
    bounds = (Bound(side=0, floor=0, ceiling=40, **bound),)
    partners = [msgspec.structs.replace(scripted(name), bounds=bounds, weight=0.5) for name in ("greedy", "stay")]
    write_manifest(tmp_path / "pool", "bounded", partners)
    scored = score("greedy", protocol, pool=tmp_path / "pool", output=tmp_path / "out")
    for scores in (scored.scores, recompute(scored.folder)):
        (layout,) = scores.layouts
        assert [(label.weight, label.bounds, label.home) for label in layout.partners] == [
            (0.5, (SideBound(0, 0, 40),), False)
        ] * 2
        mean, n = (scores.find(metric, layout="cramped_room") for metric in ("mean", "n"))
        assert n.value == pytest.approx(mean.value / 40)
        assert scores.find("pots", layout="cramped_room", params={"chef": 0}).value > 0
    assert recompute(scored.folder).rows == scored.scores.rows


def test_the_return_with_itself_enters_no_score(protocol, pool_folder, tmp_path):
    rules = changed(protocol, self_play=True, horizon=200)
    scored = score("greedy", rules, pool=pool_folder, output=tmp_path / "out")
    scores = scored.scores
    (layout,) = scores.layouts
    assert "itself" not in [label.name for label in layout.partners]
    own = scores.find("self_play", layout="cramped_room")
    with Store(scored.folder / EPISODES_FILE) as store:
        episodes = list(store.episodes())
        assert store.find({}, worst=True).kind not in ("self", "floor")
    points = [one.soup_reward for one in episodes if one.kind == "self"]
    assert len(points) == 4
    assert own.value == pytest.approx(sum(points) / len(points))
    counting = [one.soup_reward for one in episodes if one.kind not in ("self", "floor")]
    assert scores.find(layout="cramped_room").value == pytest.approx(sum(counting) / len(counting))
    assert recompute(scored.folder).rows == scores.rows


def test_a_fresh_salt_is_written_down_and_kept_for_its_folder(protocol, tmp_path, capsys):
    public, *_ = score("greedy", protocol, output=tmp_path / "public")
    assert public.salt == protocol.play.salt
    rules = tmp_path / "p.yaml"
    rules.write_text(protocol_text())
    command = ["score", "greedy", "--protocol", str(rules), "--no-scenarios", "--workers", "1", "--output"]
    assert main([*command, str(tmp_path / "fresh"), "--salt", "fresh"]) == 0
    fresh = read_scores(tmp_path / "fresh" / SCORES_FILE)
    assert len(fresh.salt) == 32
    assert f"Salt {fresh.salt}" in capsys.readouterr().out
    with Store(tmp_path / "fresh" / EPISODES_FILE) as store, Store(tmp_path / "public" / EPISODES_FILE) as other:
        assert store.facts["salt"] == fresh.salt
        starts = [{episode.start for episode in of.episodes()} for of in (store, other)]
    assert not starts[0] & starts[1], "start states follow the salt"
    assert main([*command, str(tmp_path / "fresh"), "--salt", "fresh"]) == 0, "the same folder goes on with its salt"
    assert read_scores(tmp_path / "fresh" / SCORES_FILE).salt == fresh.salt
    score("greedy", protocol, output=tmp_path / "again", salt=fresh.salt)
    assert without_run(tmp_path / "again") == without_run(tmp_path / "fresh"), "anyone who knows the salt can repeat it"
    capsys.readouterr()
    assert main([*command, str(tmp_path / "fresh")]) == 2
    assert "another salt" in capsys.readouterr().err
    assert main([*command, str(tmp_path / "public"), "--salt", "fresh"]) == 2, "a public run does not become official"
    assert "another salt" in capsys.readouterr().err
    with pytest.raises(ProtocolError, match="salt is ''"):
        score("greedy", protocol, output=tmp_path / "out", salt="")


def test_a_threshold_is_changed_without_playing_again(protocol, tmp_path):
    score("greedy", protocol, output=tmp_path / "out")
    played = []
    scores, *_ = score(
        "greedy", reporting(protocol, thresholds=(2,)), output=tmp_path / "out", on_progress=played.append
    )
    assert played == []
    assert {row.params["soups"] for row in scores.select("threshold")} == {2}


def test_a_finished_score_on_a_read_only_disk_is_shown(protocol, tmp_path, monkeypatch):
    before = score("greedy", protocol, output=tmp_path / "out").scores

    def refuse(*_):
        raise OSError(30, "Read-only file system")

    monkeypatch.setattr("overcooked_bench.evaluation.shown.report.write_whole", refuse)
    scored = score("greedy", protocol, output=tmp_path / "out")
    assert (scored.episodes, scored.scores.rows) == (0, before.rows)
    assert "Read-only file system" in scored.unwritten
    with pytest.raises(OSError, match="Read-only file system"):
        score("stay", protocol, output=tmp_path / "other")


@pytest.mark.slow
def test_several_training_runs_give_an_interval_over_them(protocol, tmp_path):
    scores, folder, *_ = score(write_agent(tmp_path / "agent.py", training_seeds=3), protocol, output=tmp_path / "out")
    assert scores.training_seeds == 3
    assert "3 training seeds" in scores.interval
    assert "needs 19" in scores.layouts[0].remark
    assert len(blocks(folder)) == 6


def test_a_pool_of_another_mode_or_layout_is_refused(pool_folder, tmp_path):
    for changes, words in (
        ({"cooking": "manual"}, "plays cooking 'manual', but the pool 'tiny' was made for 'auto'"),
        ({"mode": "greedy"}, "plays mode 'greedy'"),
        ({"layouts": ["counter_circuit"]}, "no partners for counter_circuit"),
    ):
        with pytest.raises(ProtocolError, match=words):
            score("stay", read_protocol(protocol_text(**changes), "p"), pool=pool_folder, output=tmp_path / "out")


def test_wrong_use_is_told_before_anything_is_played(protocol, tmp_path):
    with pytest.raises(ProtocolError, match="does not play counter_circuit"):
        score("stay", protocol, layouts=["counter_circuit"], output=tmp_path / "out")
    (tmp_path / "empty.py").touch()
    with pytest.raises(AgentError, match="defines no make_agent"):
        score(tmp_path / "empty.py", protocol, output=tmp_path / "out")
    with pytest.raises(EngineError, match="choose one of local, dask, ray"):
        score("stay", protocol, output=tmp_path / "out", engine="abacus")
