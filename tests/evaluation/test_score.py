"""The main job end to end: resumed, killed, spread over workers, and stopped by a fault."""

import contextlib
import json
import os
import signal
import sqlite3
import subprocess
import sys
import time

import pytest

from overcooked_bench.agents.pools.manifest import write_manifest
from overcooked_bench.agents.submissions.checks import AgentError
from overcooked_bench.cli import main
from overcooked_bench.evaluation.games.engines import EngineError
from overcooked_bench.evaluation.games.store import Store, StoreError
from overcooked_bench.evaluation.protocol import ProtocolError, read_protocol
from overcooked_bench.evaluation.score import EPISODES_FILE, SCORES_FILE, ScoringFault, score
from overcooked_bench.evaluation.scores import ScoresError, read_scores
from tests.agents.made import scripted
from tests.evaluation.made import SCRIPTED_POOL, changed, protocol_text, reporting, write_agent


def without_run(folder):
    text = (folder / SCORES_FILE).read_text()
    return text[: text.index('"run"')]


def blocks(folder):
    with Store(folder / EPISODES_FILE) as store:
        return store.blocks()


def test_a_score_is_written_and_read_back(protocol, pool_folder, tmp_path):
    seen = []
    scores, folder = score("greedy", protocol, pool=pool_folder, output=tmp_path / "out", on_progress=seen.append)
    assert sorted(file.name for file in folder.iterdir()) == [
        "curve.png",
        "episodes.sqlite",
        "report.html",
        "score.json",
    ]
    assert read_scores(folder / SCORES_FILE) == scores
    assert (scores.agent.name, scores.pool.name, scores.training_seeds) == ("greedy", "tiny", 1)
    (layout,) = scores.layouts
    assert {cell.partner: (cell.kind, cell.is_ego) for cell in layout.cells} == {
        "greedy": ("scripted", True),
        "sp-0": ("trained", False),
        "sp-1": ("trained", False),
    }
    assert [(at.blocks, at.of, at.episodes) for at in seen] == [(1, 2, 8), (2, 2, 16)]
    assert set(scores.run) >= {"seconds", "workers", "engine", "versions"}


@pytest.mark.slow
def test_two_workers_write_the_same_bytes_as_one(pool_folder, tmp_path):
    protocol = read_protocol(protocol_text(episodes=3), "p.yaml")
    agent = write_agent(tmp_path / "agent.py", act="return np.random.randint(0, 6, n)", training_seeds=2)
    for workers in (1, 2):
        score(agent, protocol, pool=pool_folder, output=tmp_path / str(workers), workers=workers)
    assert without_run(tmp_path / "1") == without_run(tmp_path / "2")
    with Store(tmp_path / "1" / EPISODES_FILE) as one, Store(tmp_path / "2" / EPISODES_FILE) as two:
        assert list(one.episodes()) == list(two.episodes())


SCORE = "import sys; from overcooked_bench.cli import main; sys.exit(main(sys.argv[1:]))"


@pytest.mark.slow
def test_a_killed_score_goes_on_where_it_was(tmp_path):
    rules = tmp_path / "p.yaml"
    rules.write_text(protocol_text(episodes=12, horizon=400))
    arguments = ["score", "greedy", "--protocol", str(rules), "--output", str(tmp_path / "killed"), "--workers", "1"]
    process = subprocess.Popen([sys.executable, "-c", SCORE, *arguments], stdout=subprocess.DEVNULL)
    file, give_up = tmp_path / "killed" / EPISODES_FILE, time.monotonic() + 120
    while time.monotonic() < give_up and not (file.exists() and _count(file)):
        time.sleep(0.01)
    os.kill(process.pid, signal.SIGKILL)
    process.wait()
    assert not (tmp_path / "killed" / SCORES_FILE).exists()
    before = blocks(tmp_path / "killed")
    assert 0 < len(before) < 12
    played = []
    protocol = read_protocol(rules.read_text(), "p.yaml")
    score("greedy", protocol, output=tmp_path / "killed", on_progress=played.append)
    assert len(played) == 12 - len(before)
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
    score("greedy", protocol, output=tmp_path / "out", on_progress=again.append)
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


def test_after_a_fault_the_played_blocks_stay(protocol, tmp_path):
    agent = write_agent(
        tmp_path / "agent.py", act="return np.full(n, 4 if self.training_seed == 0 else 6)", training_seeds=2
    )
    with pytest.raises(
        ScoringFault, match=r"cramped_room, training seed 1, episode 0, partner .*, seat .*, step 0: .*action 6"
    ):
        score(agent, protocol, output=tmp_path / "out")
    assert blocks(tmp_path / "out") == {("cramped_room", 0, 0)}


def test_a_corrected_agent_is_scored_in_the_same_folder(protocol, tmp_path):
    agent = write_agent(tmp_path / "agent.py", act="raise SystemExit(0)")
    with pytest.raises(ScoringFault, match="SystemExit: 0"):
        score(agent, protocol, output=tmp_path / "out")
    score(write_agent(agent), protocol, output=tmp_path / "out")
    assert len(blocks(tmp_path / "out")) == 2


@pytest.mark.slow
def test_after_a_fault_in_a_worker_too(protocol, tmp_path):
    agent = write_agent(tmp_path / "agent.py", act="return np.full(n, 4.5)")
    with pytest.raises(ScoringFault, match=r"step 0: .*float64"):
        score(agent, protocol, output=tmp_path / "out", workers=2)


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
    with pytest.raises(ScoringFault, match=rf"cramped_room, training seed 0, episode .: {why}"):
        score(agent, protocol, output=tmp_path / "out", workers=workers, act_timeout=2)


GRID = "XXPXX\nO   O\nX   X\nXDXSX"


@pytest.fixture
def own_kitchen(tmp_path):
    """A layout file of the user's own, and a pool of scripted partners for it."""
    (tmp_path / "bare.layout").write_text(GRID)
    write_manifest(tmp_path / "pool", "own", [scripted("greedy", layout=GRID)])
    return {"layouts": [str(tmp_path / "bare.layout")], "pool": tmp_path / "pool"}


def test_a_kitchen_of_ones_own_is_scored_with_scripted_partners(own_kitchen, tmp_path):
    scores, _ = score("stay", read_protocol(protocol_text(**own_kitchen), "p.yaml"), output=tmp_path / "out")
    assert [cell.partner for cell in scores.layouts[0].cells] == ["greedy"]


def test_a_standard_start_needs_start_cells(own_kitchen, tmp_path):
    rules = read_protocol(protocol_text(**own_kitchen, start="standard"), "p.yaml")
    with pytest.raises(ProtocolError, match="names no start cells"):
        score("stay", rules, output=tmp_path / "out")


def test_without_a_pool_nobody_is_met(protocol, tmp_path):
    with pytest.raises(ProtocolError, match="names no pool; name one with --pool"):
        score("stay", changed(protocol, pool=None), output=tmp_path / "out")
    scores, _ = score("stay", changed(protocol, pool=None), pool=SCRIPTED_POOL, output=tmp_path / "out")
    assert scores.pool.name == "scripted"


def test_a_fresh_salt_is_written_down_and_kept_for_its_folder(protocol, tmp_path, capsys):
    public, _ = score("greedy", protocol, output=tmp_path / "public")
    assert public.salt == protocol.play.salt
    rules = tmp_path / "p.yaml"
    rules.write_text(protocol_text())
    command = ["score", "greedy", "--protocol", str(rules), "--no-scenarios", "--workers", "1", "--output"]
    assert main([*command, str(tmp_path / "fresh"), "--salt", "fresh"]) == 0
    fresh = read_scores(tmp_path / "fresh" / SCORES_FILE)
    assert len(fresh.salt) == 32
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
    scores, _ = score(
        "greedy", reporting(protocol, thresholds=(2,)), output=tmp_path / "out", on_progress=played.append
    )
    assert played == []
    assert [threshold.soups for threshold in scores.layouts[0].thresholds] == [2]


def test_what_the_agent_does_not_know_is_not_attempted(tmp_path):
    protocol = read_protocol(protocol_text(layouts=["cramped_room", "coordination_ring"]), "p.yaml")
    agent = write_agent(tmp_path / "agent.py", make="if layout == 'cramped_room': raise UnknownLayout(layout)")
    scores, _ = score(agent, protocol, output=tmp_path / "out")
    assert [layout.layout for layout in scores.layouts] == ["coordination_ring"]
    assert scores.not_attempted == ("cramped_room",)
    nothing = write_agent(tmp_path / "other.py", make="raise UnknownLayout(layout)")
    scores, folder = score(nothing, protocol, output=tmp_path / "nothing")
    assert (scores.layouts, scores.overall) == ((), None)
    assert read_scores(folder / SCORES_FILE).not_attempted == ("cramped_room", "coordination_ring")


def test_a_frozen_agent_plays_its_own_layout_alone(pool_folder, tmp_path):
    protocol = read_protocol(protocol_text(layouts=["coordination_ring", "cramped_room"]), "p.yaml")
    scores, _ = score(f"{pool_folder}/cramped_room/sp-1", protocol, output=tmp_path / "out")
    assert [layout.layout for layout in scores.layouts] == ["cramped_room"]
    assert scores.not_attempted == ("coordination_ring",)
    with pytest.raises(ProtocolError, match="plays cramped_room alone"):
        score(f"{pool_folder}/cramped_room/sp-1", protocol, layouts=["coordination_ring"], output=tmp_path / "b")


def test_several_training_runs_give_an_interval_over_them(protocol, tmp_path):
    scores, folder = score(write_agent(tmp_path / "agent.py", training_seeds=3), protocol, output=tmp_path / "out")
    assert scores.training_seeds == 3
    assert "3 training seeds" in scores.interval
    assert "needs 19" in scores.layouts[0].low_quantile
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


def test_a_broken_score_json_is_refused(tmp_path):
    (tmp_path / SCORES_FILE).write_text(json.dumps({"schema": 1}))
    with pytest.raises(ScoresError, match=r"not a score\.json"):
        read_scores(tmp_path / SCORES_FILE)
